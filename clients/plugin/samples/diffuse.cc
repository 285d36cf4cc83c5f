// SPDX-License-Identifier: MIT
// Random walk: straight and in wide curves, and away from near things.
#include <cmath>

#include "cpp_controller.h"

namespace {

constexpr double kAhead_rad = 1.75;  // ignores sensors farther to the side or behind

class Diffuse {
 public:
  struct State {
    double curve_rad_s;  // of the walk
    int32_t turning;     // 1 left, -1 right: in place, away from something; 0: walking
    int32_t reserved;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "of the walk, m/s", 0.05, 0, 10},
        {"near", "turns away from what is nearer, m", 0.1, 0, 10},
        {"turn", "turn rate away from things, rad/s", 1.5, 0, 20},
        {"curve", "the walk turns at most so fast, rad/s", 0.3, 0, 20},
        {"every", "mean time between two curves, s", 3, 0.01, 1e6},
    };
    static const coopdyn_description description = {"random walk that avoids what is near", COOPDYN_DISTANCES,
                                                    sizeof(State), 5, options};
    return &description;
  }

  Diffuse(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        speed_m_s_(options[0]),
        near_m_(options[1]),
        turn_rad_s_(options[2]),
        curve_rad_s_(options[3]),
        every_s_(options[4]) {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    double nearest_m = near_m_, side = 0;
    for (size_t i = 0; i < readings.distance_count; ++i) {
      if (readings.distance_m[i] >= nearest_m || std::abs(robot_.distance_bearing_rad[i]) > kAhead_rad)
        continue;
      nearest_m = readings.distance_m[i];
      side = robot_.distance_bearing_rad[i];
    }
    if (nearest_m < near_m_) {
      // Continue a turn to the same side; else the robot would sway endlessly in a corner.
      if (state.turning == 0) state.turning = side > 0 ? -1 : 1;
      command.turn_rad_s = state.turning * turn_rad_s_;
      return;
    }
    state.turning = 0;
    if (coopdyn::Random(readings.seed, robot_.id, readings.step) < readings.step_s / every_s_) {
      state.curve_rad_s =
          curve_rad_s_ * (2 * coopdyn::Random(readings.seed, robot_.id, readings.step, 1) - 1);
    }
    command.forward_m_s = speed_m_s_;
    command.turn_rad_s = state.curve_rad_s;
  }

 private:
  const coopdyn_robot& robot_;  // outlives this
  const double speed_m_s_, near_m_, turn_rad_s_, curve_rad_s_, every_s_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Diffuse>();
}
