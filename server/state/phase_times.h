// SPDX-License-Identifier: MIT
// How long the parts of stepping have taken in all, by the wall clock; for `coopdyn bench`.
#pragma once

#include "server/base/clock.h"

namespace coopdyn {

struct PhaseTimes {
  Nanoseconds sense = 0;    // readings for loaded controllers
  Nanoseconds control = 0;  // loaded controllers, the wait for their process included
  Nanoseconds physics = 0;
  Nanoseconds publish = 0;  // making frames
};

}  // namespace coopdyn
