// SPDX-License-Identifier: MIT
// Which file a URI of a model means: model://, package://, file:// and relative ones, on the search path and
// in the model's own folder, never outside them. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

class Resources {
 public:
  /// `folders`: of the search path. `model_file`: the file that is loaded; its folder (and the ROS package
  /// that it belongs to, if there is one) may be used too.
  Resources(std::vector<std::filesystem::path> folders, const std::filesystem::path& model_file);

  /// The existing file or folder that `uri` means in the file `from`; else nothing, and `why` says what to
  /// do.
  std::optional<std::filesystem::path> Find(const std::string& uri, const std::filesystem::path& from,
                                            std::string& why) const;

 private:
  bool IsInside(const std::filesystem::path& file) const;

  std::vector<std::filesystem::path> roots_;    // without symbolic links: nothing outside them is read
  std::vector<std::filesystem::path> folders_;  // where names are looked up
  std::optional<std::filesystem::path> package_;
};

/// The SDF or URDF file of a model folder: what model.config names for the newest version, else model.sdf or
/// model.urdf.
std::optional<std::filesystem::path> ModelFileIn(const std::filesystem::path& folder);

}  // namespace coopdyn
