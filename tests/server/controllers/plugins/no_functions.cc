// SPDX-License-Identifier: MIT
#include "tests/server/controllers/plugins/loading.h"

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  static coopdyn_controller functions = With([]() -> const coopdyn_description* { return nullptr; });
  functions.step = nullptr;
  return &functions;
}
