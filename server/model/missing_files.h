// SPDX-License-Identifier: MIT
// Finds missing files of models made for other programs, and the folders that hold them (`coopdyn check
// --search`). Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/model/readers.h"

namespace coopdyn {

/// The URIs in the SDF or URDF `file` and its includes that cannot be resolved on `path`, each once. Empty if
/// `file` cannot be read.
std::vector<std::string> MissingUris(const std::filesystem::path& file, const SearchPath& path);

struct FoundFolders {
  std::vector<std::filesystem::path> folders;  // to add to a search path
  std::vector<std::string> nowhere;            // URIs that no folder has
};
/// Searches `below` and its subfolders for `uris`, breadth first, without following symbolic links.
FoundFolders FoldersWith(const std::vector<std::string>& uris, const std::filesystem::path& below);

}  // namespace coopdyn
