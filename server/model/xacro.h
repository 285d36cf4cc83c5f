// SPDX-License-Identifier: MIT
// URDF that is written with xacro, expanded by the user's own program `xacro`. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn {

struct SearchPath;

/// Whether `text` has elements of xacro, or `file` ends in .xacro. What xacro has written keeps the comments.
bool IsXacro(std::string_view text, const std::filesystem::path& file);

/// What to say of a file that came over a socket.
inline constexpr const char* kNoXacroUploads =
    "xacro that is sent is not expanded here: send what 'xacro FILE' writes";

/// What `xacro FILE` writes. Nothing, with an error at `file`, if there is no such program, it fails, takes
/// longer than a minute, or if the file is an upload of `path`, as it may name any file of this machine.
std::optional<std::string> ExpandXacro(const std::filesystem::path& file, const SearchPath& path,
                                       Diagnostics& diagnostics);

}  // namespace coopdyn
