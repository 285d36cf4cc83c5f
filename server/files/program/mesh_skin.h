// SPDX-License-Identifier: MIT
// The appearance of meshes: materials and textures of their files, which libassimp opens through coopdyn. One
// thread.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/files/wire.h"

struct aiMesh;
struct aiScene;
namespace Assimp {
class IOSystem;
}

namespace coopdyn {

/// Returns the content of the file (kNeedFile) or texture (kNeedPicture) `name` that a mesh refers to.
/// Returns nullopt and sets `why` if it is unavailable.
using AskForFile =
    std::function<std::optional<std::string>(FileTalk kind, const std::string& name, std::string& why)>;

/// The files that libassimp may open: the request's file, and files that `ask` returns. The arguments must
/// outlive the result.
std::unique_ptr<Assimp::IOSystem> MakeMeshFiles(const MeshRequest& request, const AskForFile& ask);

/// Collects the materials of one mesh's parts. `ask` must outlive the builder.
class SkinBuilder {
 public:
  explicit SkinBuilder(const AskForFile& ask) : ask_(ask) {}

  /// Adds the next part, `mesh` of `scene`.
  void Add(const aiScene& scene, const aiMesh& mesh);
  /// The colour of the first part that has one.
  const std::optional<std::array<double, 3>>& color() const { return color_; }
  /// Problems with textures.
  const std::vector<std::string>& missing() const { return missing_; }
  /// Null if color() describes the whole mesh.
  std::shared_ptr<const MeshSkin> Take();

 private:
  std::uint32_t MaterialOf(const aiScene& scene, unsigned index);
  std::shared_ptr<const Image> TextureOf(const aiScene& scene, const std::string& name);

  const AskForFile& ask_;
  std::shared_ptr<MeshSkin> skin_ = std::make_shared<MeshSkin>();
  std::map<unsigned, std::uint32_t> numbers_;  // material index by the scene's material index
  std::map<std::string, std::shared_ptr<const Image>> textures_;
  std::vector<std::string> missing_;
  std::optional<std::array<double, 3>> color_;
};

}  // namespace coopdyn
