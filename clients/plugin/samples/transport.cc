// SPDX-License-Identifier: MIT
// Carries the bar of a team2 to the target of a colour: NAME_leader leads, every other robot helps. See
// transport_dynamics.h.
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "clients/plugin/samples/transport_dynamics.h"
#include "cpp_controller.h"

namespace {

namespace transport = coopdyn::transport;

class Transport {
 public:
  struct State {
    double speed_m_s;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"red", "of the target's colour, 0 to 1", 1, 0, 1},
        {"green", "of the target's colour, 0 to 1", 0, 0, 1},
        {"blue", "of the target's colour, 0 to 1", 0, 0, 1},
    };
    static const coopdyn_description description = {"carries the bar of a team2 to the target of a colour",
                                                    COOPDYN_DISTANCES | COOPDYN_TARGETS | COOPDYN_SUPPORT,
                                                    sizeof(State), 3, options};
    return &description;
  }

  Transport(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        leads_(std::string_view(robot.name).ends_with("_leader")),
        color_{options[0], options[1], options[2]} {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    if (std::isnan(readings.support_rad)) throw std::runtime_error("this robot has no support: use a team2");
    const transport::Load load{readings.support_x_m, readings.support_y_m, readings.support_rad};
    const transport::Ranges seen{readings.distance_count, readings.distance_m, robot_.distance_bearing_rad,
                                 robot_.distance_opening_rad};
    transport::Velocity velocity;
    if (leads_) {
      const coopdyn_target* target = Target(readings);
      if (target == nullptr) return;  // the command is 0: stand still
      transport::Leader leader{state.speed_m_s};
      velocity = leader.Step(target->distance_m, target->bearing_rad, seen, load, readings.step_s);
      state.speed_m_s = leader.speed;
    } else {
      transport::Helper helper{state.speed_m_s};
      velocity = helper.Step(seen, load, readings.step_s);
      state.speed_m_s = helper.speed;
    }
    command.forward_m_s = velocity.forward;
    command.turn_rad_s = velocity.turn;
  }

 private:
  /// The nearest target of the colour.
  const coopdyn_target* Target(const coopdyn_readings& readings) const {
    const coopdyn_target* target = nullptr;
    for (size_t i = 0; i < readings.target_count; ++i) {
      const coopdyn_target& seen = readings.targets[i];
      const double off = std::max({std::abs(seen.red - color_[0]), std::abs(seen.green - color_[1]),
                                   std::abs(seen.blue - color_[2])});
      if (off < 0.1 && (target == nullptr || seen.distance_m < target->distance_m)) target = &seen;
    }
    return target;
  }

  const coopdyn_robot& robot_;
  const bool leads_;
  const double color_[3];
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Transport>();
}
