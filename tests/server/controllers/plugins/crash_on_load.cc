// SPDX-License-Identifier: MIT
#include "tests/server/controllers/plugins/loading.h"

namespace {

int* volatile nowhere = nullptr;

struct Crash {
  Crash() { *nowhere = 1; }
};
Crash crash;

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return nullptr;
}
