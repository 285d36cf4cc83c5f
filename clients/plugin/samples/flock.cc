// SPDX-License-Identifier: MIT
// Robots flock (Vicsek, Reynolds): each broadcasts its heading and steers for the mean heading of the robots
// it hears, away from near ones and towards far ones. Needs a model with a neighbours module.
#include <algorithm>
#include <cmath>

#include "cpp_controller.h"

namespace {

class Flock {
 public:
  struct State {
    char nothing;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "m/s", 0.1, 0, 10},
        {"gap", "wanted between the middles of two robots, m", 0.4, 0, 100},
        {"align", "weight of the others' headings", 1, 0, 100},
        {"attract", "weight of the wanted gap", 1, 0, 100},
        {"near", "steers away from obstacles nearer than this, m", 0.15, 0, 10},
        {"turn", "greatest turn rate, rad/s", 1.5, 0, 20},
    };
    static const coopdyn_description description = {
        "drives with those that it hears, in the same direction and with a gap",
        COOPDYN_DISTANCES | COOPDYN_POSE | COOPDYN_MESSAGES, sizeof(State), 6, options};
    return &description;
  }

  Flock(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        speed_m_s_(options[0]),
        gap_m_(options[1]),
        align_(options[2]),
        attract_(options[3]),
        near_m_(options[4]),
        turn_rad_s_(options[5]) {}

  void Reset(uint64_t /*seed*/) {}

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    // The vector to steer along; x ahead, y left. Alone, the robot drives straight on.
    double x = 1, y = 0;
    for (size_t i = 0; i < readings.heard_count; ++i) {
      const coopdyn_heard& other = readings.heard[i];
      if (other.count < 1) continue;
      const double heading = other.values[0] - readings.heading_rad;
      const double off = std::clamp((other.from.distance_m - gap_m_) / (gap_m_ + 1e-9), -1.0, 1.0);
      const double weight = 1 / static_cast<double>(readings.heard_count);
      const coopdyn::Direction theirs = coopdyn::DirectionOf(heading),
                               there = coopdyn::DirectionOf(other.from.bearing_rad);
      x += weight * (align_ * theirs.x + attract_ * off * there.x);
      y += weight * (align_ * theirs.y + attract_ * off * there.y);
    }
    for (size_t i = 0; i < readings.distance_count; ++i) {
      if (readings.distance_m[i] >= near_m_) continue;
      const coopdyn::Direction side = coopdyn::DirectionOf(robot_.distance_bearing_rad[i]);
      if (side.x < 0) continue;
      const double near = 3 * (1 - readings.distance_m[i] / near_m_);
      x -= near * side.x;
      y -= near * (side.y + 0.1);  // passes things straight ahead on the right
    }
    const double wanted = coopdyn_atan2(y, x);
    command.forward_m_s = speed_m_s_ * std::max(0.0, coopdyn_cos(wanted));
    command.turn_rad_s = std::clamp(2 * wanted, -turn_rad_s_, turn_rad_s_);
    command.message_count = 1;
    command.message[0] = readings.heading_rad;
  }

 private:
  const coopdyn_robot& robot_;
  const double speed_m_s_, gap_m_, align_, attract_, near_m_, turn_rad_s_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Flock>();
}
