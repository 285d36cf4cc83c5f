// SPDX-License-Identifier: MIT
// The unit of time in the tests of timing.
#pragma once

#include "server/base/clock.h"

namespace coopdyn {

inline constexpr Nanoseconds kMs = 1'000'000;

}  // namespace coopdyn
