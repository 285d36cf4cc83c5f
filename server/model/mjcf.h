// SPDX-License-Identifier: MIT
// Reads MuJoCo's model files (MJCF), which the program coopdyn-mjcf translates into SDF. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"
#include "server/model/resources.h"
#include "server/model/xml_tree.h"

namespace coopdyn {

/// A temporary folder for one file's meshes, removed with this object. Folders of killed processes are
/// removed later.
class MeshFolder {
 public:
  /// Also removes the folders of ended processes, if they are at least 10 minutes older.
  MeshFolder();
  ~MeshFolder();
  MeshFolder(const MeshFolder&) = delete;
  MeshFolder& operator=(const MeshFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }  // empty if it could not be created

 private:
  std::filesystem::path path_;
  int lock_ = -1;  // the kernel releases it when this process ends for any reason
};

/// True if the root element of `text` is <mujoco>.
bool IsMjcf(std::string_view text);
/// The error for an MJCF file that came over a socket.
inline constexpr const char* kNoMjcfUploads =
    "MuJoCo's files that are sent are not read here: put the file into a folder and start the daemon with "
    "--scenarios FOLDER, or send what coopdyn convert makes of it";

/// Translates `file` into the text of an SDF world. Writes meshes to `meshes`; the text refers to them as
/// `prefix` + name. Reports coopdyn-mjcf's messages at `file`. Reports an error and returns nullopt if the
/// program is missing or fails, or if the file is an upload of `path`, because it could name any file of this
/// machine.
std::optional<std::string> TranslateMjcf(const std::filesystem::path& file, const SearchPath& path,
                                         const std::filesystem::path& meshes, const std::string& prefix,
                                         Diagnostics& diagnostics);

/// The same, parsed; its elements have line 0.
std::optional<XmlNode> ReadMjcf(const std::filesystem::path& file, const SearchPath& path,
                                const MeshFolder& meshes, Diagnostics& diagnostics);
/// An SDF with the file's only robot: the only model that moves, or the only one with motors.
std::optional<XmlNode> ReadMjcfRobot(const std::filesystem::path& file, const SearchPath& path,
                                     const MeshFolder& meshes, Diagnostics& diagnostics);
/// The files that such an SDF may name.
Resources ResourcesOf(const SearchPath& path, const std::filesystem::path& file, const MeshFolder& meshes);

}  // namespace coopdyn
