// SPDX-License-Identifier: MIT
// Names of recordings as clients may give them: bare, so that nothing but the folder can be reached. Pure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace coopdyn {

inline constexpr std::string_view kRunExtension = ".run";
inline constexpr std::size_t kMaxRunName = 64;  // without .run

/// `name`, with .run unless it ends so.
std::string WithRunExtension(const std::string& name);
/// Why no recording can be called so; empty if one can. @pre `name` ends with .run
std::string RunNameObjection(const std::string& name);

}  // namespace coopdyn
