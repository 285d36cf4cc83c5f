// SPDX-License-Identifier: MIT
#include "tests/server/controllers/plugins/loading.h"

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  static const coopdyn_controller functions = With([]() -> const coopdyn_description* {
    static const coopdyn_description description = {"", 0, 4000000000, 4000000000, nullptr};
    return &description;
  });
  return &functions;
}
