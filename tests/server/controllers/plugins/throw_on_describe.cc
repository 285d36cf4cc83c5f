// SPDX-License-Identifier: MIT
#include <stdexcept>

#include "tests/server/controllers/plugins/loading.h"

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  static const coopdyn_controller functions =
      With([]() -> const coopdyn_description* { throw std::runtime_error("speechless"); });
  return &functions;
}
