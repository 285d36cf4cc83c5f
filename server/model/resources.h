// SPDX-License-Identifier: MIT
// Which file a URI of a model means: model://, package://, file://, $(find PKG), addresses of Fuel and
// relative ones, on the search path, in the model's own folder and package, never outside them. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct SearchPath;

class Resources {
 public:
  /// `model_file`: the file that is loaded; its folder (and the ROS package that it belongs to, if there is
  /// one) may be used too.
  Resources(const SearchPath& path, const std::filesystem::path& model_file);

  /// Files in `folder` may be used, too.
  void Allow(const std::filesystem::path& folder);

  /// The existing file or folder that `uri` means in the file `from`; else nothing, and `why` says what to
  /// do.
  std::optional<std::filesystem::path> Find(const std::string& uri, const std::filesystem::path& from,
                                            std::string& why) const;
  /// Whether a mesh that is not there is an error, where a box would do.
  bool is_strict() const { return is_strict_; }
  const std::filesystem::path& parts_folder() const { return parts_folder_; }

 private:
  /// Where something may be. `root`: nothing outside it is read; none: outside roots_.
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

  std::vector<std::filesystem::path> roots_;          // without symbolic links: nothing outside them is read
  std::vector<std::filesystem::path> folders_;        // where names are looked up
  std::vector<std::filesystem::path> model_folders_;  // likewise, but only those of model:// and package://
  std::vector<std::filesystem::path> fuel_folders_;
  std::optional<std::filesystem::path> package_;
  std::filesystem::path model_folder_;  // without symbolic links; empty: there is none
  bool is_strict_ = false;
  std::filesystem::path parts_folder_;
};

/// Where `uri` leads in a folder that a search path needs: NAME/FILE of model://NAME/FILE; nothing if no
/// folder helps, as with addresses.
std::optional<std::filesystem::path> PathInFolder(const std::string& uri);

/// The SDF or URDF file of a model folder: what model.config names for the newest version, else model.sdf or
/// model.urdf.
std::optional<std::filesystem::path> ModelFileIn(const std::filesystem::path& folder);

}  // namespace coopdyn
