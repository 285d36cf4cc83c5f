// SPDX-License-Identifier: MIT
// Meshes from files, and as text inside a model that a recording carries. Any thread.
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

inline constexpr std::size_t kMaxModelTriangles = 500'000;  // of all of one model
inline constexpr std::size_t kMaxMeshFileBytes = 64u << 20;

struct ModelMesh {
  std::shared_ptr<const MeshData> data;
  Vector3 middle = Vector3::Zero();  // of its box, in the frame of the file
  bool is_heights = false;           // of a <heightmap>
};

class Resources;

/// Whether meshes are read from files that end so.
bool IsMeshType(const std::filesystem::path& file);

/// The mesh of a .stl, .obj, .dae, .glb, .gltf or .ply file, each vertex times `scale`; of its part called
/// `submesh` alone if that is not empty. What else the file names is looked up in `resources`. Nothing with
/// an error at `where`.
std::optional<ModelMesh> LoadMesh(const std::filesystem::path& file, const Vector3& scale,
                                  const std::string& submesh, const Resources& resources, FileReader& reader,
                                  const SourceLine& where, Diagnostics& diagnostics);

/// The mesh of these parts, in numbers that a recording keeps.
ModelMesh MakeModelMesh(MeshParts parts);
/// Gives `mesh` its looks; its id is then another.
void SetSkin(std::shared_ptr<const MeshSkin> skin, MeshData& mesh);

/// Bytes as one word, and back; nothing for a bad word.
std::string ToBase64(const std::string& bytes);
std::optional<std::string> FromBase64(std::string_view text);

/// A mesh as one word, and back; nothing for a bad word. The word names its pictures by their places in
/// `textures`, where MeshToText() puts those that are not there yet.
std::string MeshToText(const ModelMesh& mesh, MeshTextures& textures);
std::optional<ModelMesh> MeshFromText(std::string_view text, const MeshTextures& textures);

}  // namespace coopdyn
