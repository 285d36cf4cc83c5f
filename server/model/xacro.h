// SPDX-License-Identifier: MIT
// URDF that is written with xacro, expanded by the user's own program `xacro`. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn {

/// Whether `text` has elements of xacro, or `file` ends in .xacro. What xacro has written keeps the comments.
bool IsXacro(std::string_view text, const std::filesystem::path& file);

/// What `xacro FILE` writes. Nothing, with an error at `file`, if there is no such program, it fails, or
/// takes longer than a minute.
std::optional<std::string> ExpandXacro(const std::filesystem::path& file, Diagnostics& diagnostics);

}  // namespace coopdyn
