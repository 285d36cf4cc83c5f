// SPDX-License-Identifier: MIT
// The pieces that progress is told with. Pure functions.
#pragma once

#include <string>

namespace coopdyn {

/// "[####....]", 40 characters wide; `share` done: 0…1.
std::string BarText(double share);
/// "45 s left", "12 min left" or "3.1 h left".
std::string LeftText(double seconds);

}  // namespace coopdyn
