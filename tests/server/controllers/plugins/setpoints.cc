// SPDX-License-Identifier: MIT
// Commands every channel by a set-point. Its option `deed` says how (deeds.h); it misbehaves in its sixth
// step.
#include <cmath>

#include "clients/plugin/cpp_controller.h"
#include "tests/server/controllers/plugins/deeds.h"

namespace {

class Setpoints {
 public:
  struct State {
    std::uint64_t steps;
    double phase_rad;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {{"deed", "what it does", 0, 0, 1000}};
    static const coopdyn_description description = {"commands channels", COOPDYN_CHANNELS | COOPDYN_SETPOINTS,
                                                    sizeof(State), 1, options};
    return &description;
  }

  Setpoints(const coopdyn_robot& robot, const double* options)
      : robot_(robot), deed_(static_cast<int>(options[0])) {}
  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    command.forward_m_s = command.turn_rad_s = 100;  // ignored
    const bool now = state.steps++ == 5;
    switch (deed_) {
      case coopdyn::kByForward:
      case coopdyn::kTooFast: {
        // As the daemon computes them from forward and turn.
        const double forward_m_s = deed_ == coopdyn::kTooFast ? 3 : 0.05, turn_rad_s = 0.3;
        const double half_m_s = turn_rad_s * robot_.track_m / 2;
        command.setpoints[0] = {COOPDYN_VELOCITY, (forward_m_s - half_m_s) / robot_.wheel_radius_m};
        command.setpoints[1] = {COOPDYN_VELOCITY, (forward_m_s + half_m_s) / robot_.wheel_radius_m};
        return;
      }
      case coopdyn::kOnlyOne:
        command.setpoints[0] = {COOPDYN_OFF, 7};
        command.setpoints[1] = {COOPDYN_VELOCITY, 1};
        return;
      case coopdyn::kNoSuchMode:
        if (now) command.setpoints[1].mode = 9;
        return;
      case coopdyn::kModeNotTaken:
        if (now) command.setpoints[1] = {COOPDYN_EFFORT, 0.1};
        return;
      case coopdyn::kReferenceNotANumber:
        if (now) command.setpoints[0] = {COOPDYN_VELOCITY, std::nan("")};
        return;
      case coopdyn::kOtherPointer: {
        static coopdyn_setpoint others[2] = {};
        if (now) command.setpoints = others;
        return;
      }
      case coopdyn::kWritePastSetpoints:
        if (now) const_cast<volatile double&>(command.setpoints[robot_.channel_count].reference) = 1;
        return;
      default:
        state.phase_rad += readings.step_s;
        for (std::size_t i = 0; i < readings.channel_count; ++i) {
          command.setpoints[i] = {COOPDYN_VELOCITY, std::sin(state.phase_rad + static_cast<double>(i)) -
                                                        0.1 * readings.channels[i].position};
        }
    }
  }

 private:
  const coopdyn_robot& robot_;
  const int deed_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Setpoints>();
}
