// SPDX-License-Identifier: MIT
// Requests the world, like a supervisor, and also a robot's distances.
#include "clients/plugin/cpp_controller.h"

namespace {

struct TwoMinds {
  struct State {
    char nothing;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_description description = {"wants all", COOPDYN_WORLD | COOPDYN_DISTANCES,
                                                    sizeof(State), 0, nullptr};
    return &description;
  }
  TwoMinds(const coopdyn_robot& /*robot*/, const double* /*options*/) {}
  void Reset(std::uint64_t /*seed*/) {}
  void Step(const coopdyn_readings& /*readings*/, coopdyn_command& /*command*/) {}
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<TwoMinds>();
}
