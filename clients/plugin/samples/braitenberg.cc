// SPDX-License-Identifier: MIT
// Braitenberg's vehicle 3b, "explorer": every distance sensor slows the wheel on the other side, so the robot
// turns away from near things. No memory, no decision.
#include <cmath>

#include "cpp_controller.h"

namespace {

class Braitenberg {
 public:
  struct State {
    char nothing;  // a controller with memory keeps it here
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "where nothing is near, m/s", 0.1, 0, 10},
        {"range", "things beyond do not matter, m", 0.3, 0.001, 100},
        {"gain", "how strongly a thing at no distance slows a wheel; 1: to a halt", 2.5, 0, 100},
    };
    static const coopdyn_description description = {"each distance sensor slows the wheel on the other side",
                                                    COOPDYN_DISTANCES, sizeof(State), 3, options};
    return &description;
  }

  Braitenberg(const coopdyn_robot& robot, const double* options)
      : robot_(robot), speed_m_s_(options[0]), range_m_(options[1]), gain_(options[2]) {}

  void Reset(uint64_t /*seed*/) {}

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    double left = 1, right = 1;  // share of the speed
    for (size_t i = 0; i < readings.distance_count; ++i) {
      const double bearing = robot_.distance_bearing_rad[i];
      const double ahead = coopdyn_cos(bearing);
      if (ahead <= 0 || readings.distance_m[i] >= range_m_) continue;
      const double near = gain_ * ahead * (1 - readings.distance_m[i] / range_m_);
      // Straight ahead counts as left; else the robot would drive into a wall at a right angle.
      (bearing >= 0 ? right : left) -= near;
    }
    left = std::fmax(left, -1);
    right = std::fmax(right, -1);
    command.forward_m_s = speed_m_s_ * (left + right) / 2;
    command.turn_rad_s = speed_m_s_ * (right - left) / robot_.track_m;
  }

 private:
  const coopdyn_robot& robot_;
  const double speed_m_s_, range_m_, gain_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Braitenberg>();
}
