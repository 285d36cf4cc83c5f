// SPDX-License-Identifier: MIT
// `coopdyn new-controller NAME`: a folder with a controller to begin with, ready to build. Main thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coopdyn {

/// Writes folder/name with all files; says on stdout what to do next, or on stderr why it did nothing.
/// Returns the exit code. Nothing that exists is overwritten.
int NewController(const std::string& name, const std::filesystem::path& folder);

/// A file to write; "@NAME@" in its name and text stands for the controller's name. Built in from
/// clients/plugin.
struct SkeletonFile {
  std::string name, text;
};
std::vector<SkeletonFile> SkeletonFiles();

}  // namespace coopdyn
