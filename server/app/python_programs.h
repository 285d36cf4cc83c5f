// SPDX-License-Identifier: MIT
// Where the parts of coopdyn are that are written in Python. Any thread.
#pragma once

#include <filesystem>
#include <string>

namespace coopdyn {

/// The interpreter: a path, or a name in PATH.
std::string PythonProgram();
/// The folder that has clients/NAME: of the sources or of the installation. Empty: there is none.
std::filesystem::path FolderWithClient(const std::string& name);

}  // namespace coopdyn
