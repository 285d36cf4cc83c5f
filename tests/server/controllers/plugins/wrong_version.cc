// SPDX-License-Identifier: MIT
#include "tests/server/controllers/plugins/loading.h"

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  static coopdyn_controller functions = With(nullptr);
  functions.version = 77;
  return &functions;
}
