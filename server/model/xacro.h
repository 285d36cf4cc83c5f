// SPDX-License-Identifier: MIT
// Expands URDF written with xacro, by the user's own program `xacro`. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn {

struct SearchPath;

/// True if `text` has xacro elements outside comments, or `file` ends in .xacro. xacro's output keeps
/// comments.
bool IsXacro(std::string_view text, const std::filesystem::path& file);

/// The error for an xacro file that came over a socket.
inline constexpr const char* kNoXacroUploads =
    "xacro that is sent is not expanded here: send what 'xacro FILE' writes";

/// The output of `xacro FILE`. Reports an error at `file` and returns nullopt if the program is missing,
/// fails, or writes nothing for a minute or too much, or if the file is an upload of `path`, because it could
/// name any file of this machine.
std::optional<std::string> ExpandXacro(const std::filesystem::path& file, const SearchPath& path,
                                       Diagnostics& diagnostics);

}  // namespace coopdyn
