// SPDX-License-Identifier: MIT
// Logs the number of its steps, and twice that number.
#include "clients/plugin/cpp_controller.h"

namespace {

struct Logger {
  struct State {
    double steps;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_description description = {"logs", 0, sizeof(State), 0, nullptr};
    return &description;
  }
  Logger(const coopdyn_robot& /*robot*/, const double* /*options*/) {}
  void Reset(std::uint64_t /*seed*/) { state = {}; }
  void Step(const coopdyn_readings& /*readings*/, coopdyn_command& command) {
    coopdyn_log(&command, "steps", state.steps);
    coopdyn_log(&command, "twice", 2 * state.steps);
    ++state.steps;
  }
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Logger>();
}
