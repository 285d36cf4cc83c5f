// SPDX-License-Identifier: MIT
// Exchanges the values of its robot's channel for a test: broadcasts the number of motors and values, the
// internal maximum of the last motor, whether the last value is auxiliary, the time of an exchange, both
// values and the option `gain`; sets motors to gain times the number of calls. In the call of option `nan` it
// returns nan, in that of `end` it ends the run.
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "clients/plugin/cpp_controller.h"

namespace {

class Mapped {
 public:
  struct State {
    uint64_t calls;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_description description = {"shows its channel", COOPDYN_MAPPED, sizeof(State),
                                                    COOPDYN_ANY_OPTIONS, nullptr};
    return &description;
  }

  Mapped(const coopdyn_robot& robot, const double* options) : robot_(robot) {
    for (size_t i = 0; i < robot.option_count; ++i) {
      const coopdyn_given& given = robot.options[i];
      if (given.value != options[i]) throw std::runtime_error("the options differ");
      if (std::strcmp(given.name, "gain") == 0) gain_ = given.value;
      if (std::strcmp(given.name, "nan") == 0) nan_ = given.value;
      if (std::strcmp(given.name, "end") == 0) end_ = given.value;
    }
  }
  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& r, coopdyn_command& command) {
    ++state.calls;
    const auto show = [&command](double value) { command.message[command.message_count++] = value; };
    show(static_cast<double>(robot_.motor_count));
    show(static_cast<double>(robot_.mapped_count));
    show(robot_.motors[robot_.motor_count - 1].internal_max);
    show(robot_.mapped[robot_.mapped_count - 1].auxiliary);
    show(robot_.exchange_s);
    show(r.mapped[0]);
    show(r.mapped[1]);
    show(gain_);
    const auto calls = static_cast<double>(state.calls);
    for (size_t i = 0; i < robot_.motor_count; ++i) command.motors[i] = gain_ * calls;
    if (calls == nan_) command.motors[1] = std::nan("");
    if (calls == end_) command.end_run = 1;
  }

 private:
  const coopdyn_robot& robot_;
  double gain_ = 0, nan_ = 0, end_ = 0;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Mapped>();
}
