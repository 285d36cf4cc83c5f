// SPDX-License-Identifier: MIT
// Drives past obstacles to the target of a colour. The heading is a dynamical system (Schoener, Dose, Engels;
// Bicho): the target's bearing attracts it, every distance sensor that sees something near repels it,
//
//   dphi/dt = l sin(psi) - sum_i l_i psi_i exp(-psi_i^2 / (2 s_i^2)),   l_i = b1 exp(-d_i / b2),
//   s_i = atan(tan(opening_i / 2) + R / (R + d_i)),
//
// and the speed relaxes to the value that target or obstacles allow. Same numbers as
// clients/python/attractor.py.
#include <algorithm>
#include <cmath>
#include <limits>

#include "cpp_controller.h"

namespace {

constexpr double kTargetStrength_rad_s = 1.6, kObstacleStrength_1_s = 10, kObstacleDecay_m = 0.3;
constexpr double kBias_rad_s = 0.02;  // turns off a heading exactly between left and right
constexpr double kTimeToTarget_s = 1.5, kTimeToContact_s = 1.2, kRelaxation_1_s = 8;
constexpr double kAhead_rad = 0.873, kPi = 3.14159265358979323846;

class Attractor {
 public:
  struct State {
    double speed_m_s;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "greatest speed, m/s", 0.5, 0, 10},
        {"turn", "greatest turn rate, rad/s", 1.8, 0, 20},
        {"reached", "stops so near the target, m", 0.4, 0, 100},
        {"red", "of the target's colour, 0 to 1", 1, 0, 1},
        {"green", "of the target's colour, 0 to 1", 0, 0, 1},
        {"blue", "of the target's colour, 0 to 1", 0, 0, 1},
    };
    static const coopdyn_description description = {"drives to the target of a colour past obstacles",
                                                    COOPDYN_DISTANCES | COOPDYN_TARGETS, sizeof(State), 6,
                                                    options};
    return &description;
  }

  Attractor(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        max_speed_m_s_(options[0]),
        max_turn_rad_s_(options[1]),
        reached_m_(options[2]),
        color_{options[3], options[4], options[5]} {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    const coopdyn_target* target = nullptr;  // nearest target of the colour
    for (size_t i = 0; i < readings.target_count; ++i) {
      const coopdyn_target& seen = readings.targets[i];
      const double off = std::max({std::abs(seen.red - color_[0]), std::abs(seen.green - color_[1]),
                                   std::abs(seen.blue - color_[2])});
      if (off < 0.1 && (target == nullptr || seen.distance_m < target->distance_m)) target = &seen;
    }
    if (target == nullptr || target->distance_m < reached_m_) {
      state.speed_m_s = 0;
      return;  // the command is 0: stand still
    }
    double turn = kTargetStrength_rad_s * coopdyn_sin(target->bearing_rad) + kBias_rad_s;
    double potential = 0, free_m = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < readings.distance_count; ++i) {
      const double d = readings.distance_m[i], psi = robot_.distance_bearing_rad[i];
      if (std::isinf(d)) continue;
      const double radius = robot_.radius_m;
      const double strength = kObstacleStrength_1_s * coopdyn_exp(-d / kObstacleDecay_m);
      const double width =
          coopdyn_atan(coopdyn_tan(robot_.distance_opening_rad[i] / 2) + radius / (radius + d));
      const double gauss = coopdyn_exp(-psi * psi / (2 * width * width));
      turn -= strength * psi * gauss;
      potential += strength * width * width * (gauss - coopdyn_exp(-0.5));
      if (std::abs(psi) <= kAhead_rad) free_m = std::min(free_m, d);
    }
    const double near = coopdyn_atan(8 * potential) / kPi;  // -1/2: nothing near ahead, 1/2: much
    const double by_target = std::min(max_speed_m_s_, target->distance_m / kTimeToTarget_s) *
                             std::max(0.1, coopdyn_cos(target->bearing_rad / 2));
    const double by_obstacles = std::min(max_speed_m_s_, free_m / kTimeToContact_s);
    const double wanted = (0.5 - near) * by_target + (0.5 + near) * std::min(by_target, by_obstacles);
    state.speed_m_s = wanted + (state.speed_m_s - wanted) * coopdyn_exp(-kRelaxation_1_s * readings.step_s);
    command.forward_m_s = state.speed_m_s;
    command.turn_rad_s = std::clamp(turn, -max_turn_rad_s_, max_turn_rad_s_);
  }

 private:
  const coopdyn_robot& robot_;
  const double max_speed_m_s_, max_turn_rad_s_, reached_m_;
  const double color_[3];
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Attractor>();
}
