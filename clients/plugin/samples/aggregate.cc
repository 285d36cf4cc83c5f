// SPDX-License-Identifier: MIT
// Robots gather: each drives to the middle of its visible neighbours, and walks at random while it sees none.
// Needs a model with a neighbours module.
#include <algorithm>
#include <cmath>

#include "cpp_controller.h"

namespace {

class Aggregate {
 public:
  struct State {
    double curve_rad_s;  // of the random walk
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "m/s", 0.1, 0, 10},
        {"gap", "keeps so far from others and from walls, m", 0.05, 0, 10},
        {"turn", "greatest turn rate, rad/s", 1.5, 0, 20},
    };
    static const coopdyn_description description = {"gathers where the neighbours are",
                                                    COOPDYN_DISTANCES | COOPDYN_NEIGHBOURS, sizeof(State), 3,
                                                    options};
    return &description;
  }

  Aggregate(const coopdyn_robot& robot, const double* options)
      : robot_(robot), speed_m_s_(options[0]), gap_m_(options[1]), turn_rad_s_(options[2]) {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    double forward = 1, bearing = 0;  // wanted share of the speed, and direction
    if (readings.neighbour_count == 0) {
      if (coopdyn::Random(readings.seed, robot_.id, readings.step) < readings.step_s / 2) {
        state.curve_rad_s = 2 * coopdyn::Random(readings.seed, robot_.id, readings.step, 1) - 1;
      }
      command.turn_rad_s = state.curve_rad_s;
    } else {
      double x_m = 0, y_m = 0;  // of the neighbours' middle; x ahead, y left
      for (size_t i = 0; i < readings.neighbour_count; ++i) {
        const coopdyn_sighting& other = readings.neighbours[i];
        const coopdyn::Direction there = coopdyn::DirectionOf(other.bearing_rad);
        x_m += other.distance_m * there.x;
        y_m += other.distance_m * there.y;
      }
      bearing = coopdyn_atan2(y_m, x_m);
      const double middle_m = coopdyn_hypot(x_m, y_m) / static_cast<double>(readings.neighbour_count);
      forward = std::clamp(middle_m / (4 * robot_.radius_m), 0.0, 1.0) * std::max(0.0, coopdyn_cos(bearing));
      command.turn_rad_s = std::clamp(3 * bearing, -turn_rad_s_, turn_rad_s_);
    }
    // Keep the gap in the direction of travel.
    for (size_t i = 0; i < readings.distance_count; ++i) {
      const double side = robot_.distance_bearing_rad[i];
      if (readings.distance_m[i] > gap_m_ || coopdyn_cos(side) < 0.3) continue;
      forward = 0;
      if (readings.neighbour_count == 0) command.turn_rad_s = side > 0 ? -turn_rad_s_ : turn_rad_s_;
    }
    command.forward_m_s = speed_m_s_ * forward;
  }

 private:
  const coopdyn_robot& robot_;
  const double speed_m_s_, gap_m_, turn_rad_s_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Aggregate>();
}
