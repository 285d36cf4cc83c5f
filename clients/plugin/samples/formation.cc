// SPDX-License-Identifier: MIT
// Keeps a formation on the way to the red target. Place 0 leads; each robot broadcasts its place, heading,
// speed, turn rate and distance from its place. See formation_dynamics.h.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "clients/plugin/samples/formation_dynamics.h"
#include "cpp_controller.h"

namespace {

namespace formation = coopdyn::formation;

class Formation {
 public:
  struct State {
    double speed_m_s;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"place", "in the formation: 0 leads, odd ones are on its left, even ones on its right", 0, 0, 98},
        {"along", "from row to row, m", 1, 0, 100},
        {"across", "from the middle to the first row's robots, m", 1, 0, 100},
    };
    static const coopdyn_description description = {
        "keeps an inverted V or a triangle on the way to the red target",
        COOPDYN_DISTANCES | COOPDYN_TARGETS | COOPDYN_MESSAGES | COOPDYN_COMPASS, sizeof(State), 3, options};
    return &description;
  }

  Formation(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        number_(static_cast<int>(std::lround(options[0]))),
        place_(formation::PlaceOf(number_, options[1], options[2])) {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    if (std::isnan(readings.compass_rad)) {
      throw std::runtime_error("this robot has no compass: use a transporter or a minibot");
    }
    const formation::Ranges seen{readings.distance_count, readings.distance_m, robot_.distance_bearing_rad,
                                 robot_.distance_opening_rad};
    formation::Robot controller{state.speed_m_s};
    formation::Velocity velocity;
    double error_m = 0;
    if (number_ == 0) {
      double worst_m = 0;
      for (size_t i = 0; i < readings.heard_count; ++i) {
        if (IsMate(readings.heard[i])) worst_m = std::max(worst_m, readings.heard[i].values[4]);
      }
      if (const coopdyn_target* target = RedTarget(readings)) {
        velocity = controller.Lead(target->distance_m, target->bearing_rad, worst_m, seen, readings.step_s);
      }
    } else {
      for (size_t i = 0; i < readings.heard_count; ++i) {
        const coopdyn_heard& heard = readings.heard[i];
        if (!IsMate(heard) || heard.values[0] != 0) continue;
        const formation::Mate leader{heard.from.distance_m, heard.from.bearing_rad,
                                     heard.values[1] - readings.compass_rad, heard.values[2],
                                     heard.values[3]};
        const formation::Place off = formation::Robot::Error(leader, place_);
        error_m = coopdyn_hypot(off.x, off.y);
        velocity = controller.Follow(leader, place_, seen, readings.step_s);
      }
    }
    state.speed_m_s = controller.speed;
    command.forward_m_s = velocity.forward;
    command.turn_rad_s = velocity.turn;
    const double message[] = {static_cast<double>(number_), readings.compass_rad, velocity.forward,
                              velocity.turn, error_m};
    command.message_count = kMessage;
    std::copy_n(message, kMessage, command.message);
  }

 private:
  static constexpr uint32_t kMessage = 5;

  static bool IsMate(const coopdyn_heard& heard) { return heard.count == kMessage; }
  static const coopdyn_target* RedTarget(const coopdyn_readings& readings) {
    const coopdyn_target* target = nullptr;
    for (size_t i = 0; i < readings.target_count; ++i) {
      const coopdyn_target& one = readings.targets[i];
      if (one.red < 0.9 || one.green > 0.1 || one.blue > 0.1) continue;
      if (target == nullptr || one.distance_m < target->distance_m) target = &one;
    }
    return target;
  }

  const coopdyn_robot& robot_;
  const int number_;
  const formation::Place place_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Formation>();
}
