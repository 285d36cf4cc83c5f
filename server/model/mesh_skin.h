// SPDX-License-Identifier: MIT
// How meshes look: materials and textures of their files, which libassimp finds through us. One thread.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/geometry/mesh.h"
#include "server/model/resources.h"

struct aiMesh;
struct aiScene;
namespace Assimp {
class IOSystem;
}

namespace coopdyn {

/// The files that libassimp may open: `file`, whose content is `bytes`, and what is on the search path.
/// The arguments outlive it.
std::unique_ptr<Assimp::IOSystem> MakeMeshFiles(const std::filesystem::path& file, const std::string& bytes,
                                                const Resources& resources);

/// Gathers the materials of the parts of one mesh. The arguments outlive it.
class SkinBuilder {
 public:
  SkinBuilder(const std::filesystem::path& file, const Resources& resources)
      : file_(file), resources_(resources) {}

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

  const std::filesystem::path& file_;
  const Resources& resources_;
  std::shared_ptr<MeshSkin> skin_ = std::make_shared<MeshSkin>();
  std::map<unsigned, std::uint32_t> numbers_;  // of materials, by that of the scene
  std::map<std::string, std::shared_ptr<const Image>> textures_;
  std::vector<std::string> missing_;
  std::optional<std::array<double, 3>> color_;
};

/// The material that a texture makes: multiplied by `tint`.
MeshSkin::Material TexturedMaterial(std::shared_ptr<const Image> texture, const std::array<double, 3>& tint);
/// Gives `mesh` its looks; its id is then another.
void SetSkin(std::shared_ptr<const MeshSkin> skin, MeshData& mesh);

}  // namespace coopdyn
