// SPDX-License-Identifier: MIT
// Text of others, fit for a terminal. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

namespace coopdyn {

/// `text` with ? for each control character, also for the ends of lines.
std::string Printable(std::string_view text);

}  // namespace coopdyn
