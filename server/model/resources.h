// SPDX-License-Identifier: MIT
// Resolves a model's URIs to files: model://, package://, file://, $(find PKG), Fuel addresses and relative
// ones, on the search path and in the model's own folder and package, never outside them. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct SearchPath;

class Resources {
 public:
  /// `model_file`: the loaded file. Its folder (and its ROS package, if any) may be used too.
  Resources(const SearchPath& path, const std::filesystem::path& model_file);

  /// Also allows files in `folder`.
  void Allow(const std::filesystem::path& folder);

  /// The existing file or folder to which `uri` in the file `from` refers. Returns nullopt if none; `why`
  /// then says what to do.
  std::optional<std::filesystem::path> Find(const std::string& uri, const std::filesystem::path& from,
                                            std::string& why) const;
  /// True if a missing mesh is an error, even where a box could replace it.
  bool is_strict() const { return is_strict_; }
  const std::filesystem::path& parts_folder() const { return parts_folder_; }

 private:
  /// A candidate file. `root`: nothing outside it is read; nullopt: nothing outside roots_.
  struct Place {
    std::filesystem::path file;
    std::optional<std::filesystem::path> root;
  };
  void AddNamed(const std::string& path, const std::filesystem::path& folder,
                std::vector<Place>& places) const;
  std::optional<std::filesystem::path> FindFuel(const std::string& uri, std::string& why) const;
  bool IsInside(const std::filesystem::path& file) const;
  std::optional<std::filesystem::path> PackageAround(const std::filesystem::path& from) const;
  std::string WhereLooked(const std::filesystem::path& folder, bool by_name) const;

  std::vector<std::filesystem::path> roots_;          // canonical; nothing outside them is read
  std::vector<std::filesystem::path> folders_;        // for look-ups of names
  std::vector<std::filesystem::path> model_folders_;  // for look-ups of model:// and package:// only
  std::vector<std::filesystem::path> fuel_folders_;
  std::optional<std::filesystem::path> package_;
  std::filesystem::path model_folder_;  // canonical; empty if none
  bool is_strict_ = false;
  std::filesystem::path parts_folder_;
};

/// The path of `uri` inside a folder of the search path: NAME/FILE for model://NAME/FILE. Returns nullopt if
/// no folder can resolve it, e.g. for web addresses.
std::optional<std::filesystem::path> PathInFolder(const std::string& uri);

/// The SDF or URDF file of a model folder: the file that model.config names for the newest version, else
/// model.sdf or model.urdf.
std::optional<std::filesystem::path> ModelFileIn(const std::filesystem::path& folder);

}  // namespace coopdyn
