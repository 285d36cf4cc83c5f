// SPDX-License-Identifier: MIT
// MuJoCo's model files (MJCF), which the program coopdyn-mjcf writes as SDF. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"
#include "server/model/resources.h"
#include "server/model/xml_tree.h"

namespace coopdyn {

/// A folder for the meshes of one file, which ends with this object.
class MeshFolder {
 public:
  MeshFolder();
  ~MeshFolder();
  MeshFolder(const MeshFolder&) = delete;
  MeshFolder& operator=(const MeshFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }  // empty: there is no room for it

 private:
  std::filesystem::path path_;
};

/// Whether `text` has the root element <mujoco>.
bool IsMjcf(std::string_view text);

/// `file` as the text of an SDF world, its meshes in `meshes`, which it calls `prefix` + name. What
/// coopdyn-mjcf says is reported at `file`. Nothing, with an error, if there is no such program, or it fails.
std::optional<std::string> TranslateMjcf(const std::filesystem::path& file,
                                         const std::filesystem::path& meshes, const std::string& prefix,
                                         Diagnostics& diagnostics);

/// The same to be read: its parts stand at no line.
std::optional<XmlNode> ReadMjcf(const std::filesystem::path& file, const MeshFolder& meshes,
                                Diagnostics& diagnostics);
/// An SDF with the one model of it that is a robot: the only one that moves, or that has motors.
std::optional<XmlNode> ReadMjcfRobot(const std::filesystem::path& file, const MeshFolder& meshes,
                                     Diagnostics& diagnostics);
/// What such an SDF may name.
Resources ResourcesOf(const SearchPath& path, const std::filesystem::path& file, const MeshFolder& meshes);

}  // namespace coopdyn
