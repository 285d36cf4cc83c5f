// SPDX-License-Identifier: MIT
#include <unistd.h>

#include "tests/server/controllers/plugins/loading.h"

namespace {

struct Hang {
  Hang() {
    for (;;) pause();
  }
};
Hang hang;

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return nullptr;
}
