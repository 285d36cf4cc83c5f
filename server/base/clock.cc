// SPDX-License-Identifier: MIT
#include "server/base/clock.h"

#include <chrono>

namespace coopdyn {

Nanoseconds SteadyClock::Now() const {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace coopdyn
