// SPDX-License-Identifier: MIT
// The unit in which tests of timing count.
#pragma once

#include "server/base/clock.h"

namespace coopdyn {

inline constexpr Nanoseconds kMs = 1'000'000;

}  // namespace coopdyn
