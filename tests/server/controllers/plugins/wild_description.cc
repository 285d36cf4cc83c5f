// SPDX-License-Identifier: MIT
// Its option's name is a wild pointer.
#include "tests/server/controllers/plugins/loading.h"

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  static const coopdyn_controller functions = With([]() -> const coopdyn_description* {
    static const coopdyn_option option = {reinterpret_cast<const char*>(8), "", 0, 0, 0};
    static const coopdyn_description description = {"", 0, 0, 1, &option};
    return &description;
  });
  return &functions;
}
