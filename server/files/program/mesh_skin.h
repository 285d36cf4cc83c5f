// SPDX-License-Identifier: MIT
// How meshes look: materials and textures of their files, which libassimp finds through us. One thread.
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

/// The content of a file that a mesh calls `name` (kNeedFile), or of a texture (kNeedPicture). Nothing, and
/// `why`, if there is none.
using AskForFile =
    std::function<std::optional<std::string>(FileTalk kind, const std::string& name, std::string& why)>;

/// The files that libassimp may open: that of the request, and what `ask` knows. The arguments outlive it.
std::unique_ptr<Assimp::IOSystem> MakeMeshFiles(const MeshRequest& request, const AskForFile& ask);

/// Gathers the materials of the parts of one mesh. `ask` outlives it.
class SkinBuilder {
 public:
  explicit SkinBuilder(const AskForFile& ask) : ask_(ask) {}

  /// The next part: `mesh` of `scene`.
  void Add(const aiScene& scene, const aiMesh& mesh);
  /// Of the first part that says one.
  const std::optional<std::array<double, 3>>& color() const { return color_; }
  /// What is wrong with textures.
  const std::vector<std::string>& missing() const { return missing_; }
  /// Null if color() says it all.
  std::shared_ptr<const MeshSkin> Take();

 private:
  std::uint32_t MaterialOf(const aiScene& scene, unsigned index);
  std::shared_ptr<const Image> TextureOf(const aiScene& scene, const std::string& name);

  const AskForFile& ask_;
  std::shared_ptr<MeshSkin> skin_ = std::make_shared<MeshSkin>();
  std::map<unsigned, std::uint32_t> numbers_;  // of materials, by that of the scene
  std::map<std::string, std::shared_ptr<const Image>> textures_;
  std::vector<std::string> missing_;
  std::optional<std::array<double, 3>> color_;
};

}  // namespace coopdyn
