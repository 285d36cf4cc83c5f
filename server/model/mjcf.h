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

/// A folder for the meshes of one file, which ends with this object, or soon after a process that is killed.
class MeshFolder {
 public:
  /// Also removes those of processes that have ended, if they are 10 minutes older.
  MeshFolder();
  ~MeshFolder();
  MeshFolder(const MeshFolder&) = delete;
  MeshFolder& operator=(const MeshFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }  // empty: there is no room for it

 private:
  std::filesystem::path path_;
  int lock_ = -1;  // which the kernel opens when this process ends, however that is
};

/// Whether `text` has the root element <mujoco>.
bool IsMjcf(std::string_view text);
/// What to say of one that came over a socket.
inline constexpr const char* kNoMjcfUploads =
    "MuJoCo's files that are sent are not read here: put the file into a folder and start the daemon with "
    "--scenarios FOLDER, or send what coopdyn convert makes of it";

/// `file` as the text of an SDF world, its meshes in `meshes`, which it calls `prefix` + name. What
/// coopdyn-mjcf says is reported at `file`. Nothing, with an error, if there is no such program, if it fails,
/// or if the file is an upload of `path`, as it may name any file of this machine.
std::optional<std::string> TranslateMjcf(const std::filesystem::path& file, const SearchPath& path,
                                         const std::filesystem::path& meshes, const std::string& prefix,
                                         Diagnostics& diagnostics);

/// The same to be read: its parts stand at no line.
std::optional<XmlNode> ReadMjcf(const std::filesystem::path& file, const SearchPath& path,
                                const MeshFolder& meshes, Diagnostics& diagnostics);
/// An SDF with the one model of it that is a robot: the only one that moves, or that has motors.
std::optional<XmlNode> ReadMjcfRobot(const std::filesystem::path& file, const SearchPath& path,
                                     const MeshFolder& meshes, Diagnostics& diagnostics);
/// What such an SDF may name.
Resources ResourcesOf(const SearchPath& path, const std::filesystem::path& file, const MeshFolder& meshes);

}  // namespace coopdyn
