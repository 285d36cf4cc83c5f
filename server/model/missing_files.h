// SPDX-License-Identifier: MIT
// What models of other programs name and is not found, and the folders that hold it (`coopdyn check
// --search`). Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/model/readers.h"

namespace coopdyn {

/// The URIs in the SDF or URDF `file`, and in what it includes, that lead nowhere on `path`, each once; none
/// of a file that cannot be read.
std::vector<std::string> MissingUris(const std::filesystem::path& file, const SearchPath& path);

struct FoundFolders {
  std::vector<std::filesystem::path> folders;  // that a search path needs
  std::vector<std::string> nowhere;            // URIs that no folder has
};
/// Looks for `uris` in `below` and its subfolders, the upper ones first; symbolic links are not followed.
FoundFolders FoldersWith(const std::vector<std::string>& uris, const std::filesystem::path& below);

}  // namespace coopdyn
