// SPDX-License-Identifier: MIT
// Reads meshes from files, and from text inside a recorded model. Any thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/files/file_reader.h"
#include "server/files/mesh_parts.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

inline constexpr std::size_t kMaxModelTriangles = 500'000;  // of all meshes of a model
inline constexpr std::size_t kMaxMeshFileBytes = 64u << 20;

struct ModelMesh {
  std::shared_ptr<const MeshData> data;
  Vector3 middle = Vector3::Zero();  // centre of its bounding box, in the file's frame
  bool is_heights = false;           // from a <heightmap>
};

class Resources;

/// True if the file's extension is that of a supported mesh format.
bool IsMeshType(const std::filesystem::path& file);

/// The mesh of a .stl, .obj, .dae, .glb, .gltf or .ply file, with each vertex multiplied by `scale`. Reads
/// only the part `submesh` if that is not empty. Looks up files that the mesh names in `resources`. Reports
/// an error at `where` and returns nullopt on failure.
std::optional<ModelMesh> LoadMesh(const std::filesystem::path& file, const Vector3& scale,
                                  const std::string& submesh, const Resources& resources, FileReader& reader,
                                  const SourceLine& where, Diagnostics& diagnostics);

/// The mesh of these parts, with numbers that survive recording unchanged.
ModelMesh MakeModelMesh(MeshParts parts);
/// Sets the skin of `mesh`, which changes its id.
void SetSkin(std::shared_ptr<const MeshSkin> skin, MeshData& mesh);

/// Encode bytes as one word and back; nullopt for a bad word.
std::string ToBase64(const std::string& bytes);
std::optional<std::string> FromBase64(std::string_view text);

/// Encode a mesh as one word and back; nullopt for a bad word. The word refers to textures by their index in
/// `textures`, to which MeshToText() appends missing ones.
std::string MeshToText(const ModelMesh& mesh, MeshTextures& textures);
std::optional<ModelMesh> MeshFromText(std::string_view text, const MeshTextures& textures);

}  // namespace coopdyn
