// SPDX-License-Identifier: MIT
// The content of a mesh file before any computation, and its serialization. Pure; any thread.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

inline constexpr std::size_t kMaxMeshTriangles = 200'000;    // per mesh; larger meshes are reduced to this
inline constexpr std::size_t kMaxReadTriangles = 2'000'000;  // of a file
inline constexpr double kMaxVertex_m = 1e4;                  // from the origin, along each axis

struct MeshParts {
  std::vector<Vector3> vertices;  // in the file's frame
  std::vector<MeshData::Triangle> triangles;
  std::optional<std::array<double, 3>> color;
  std::shared_ptr<const MeshSkin> skin;  // null: uniform `color`
};

/// Rounds and orders the parts so that serialization preserves them exactly.
MeshParts Settled(MeshParts parts);

/// The textures of meshes, each once.
using MeshTextures = std::vector<std::shared_ptr<const Image>>;

/// Serialize parts and back; nullopt for bad bytes. Zero padding may follow the bytes. They refer to textures
/// by their index in `textures`, to which MeshToBytes() appends missing ones.
std::string MeshToBytes(const MeshParts& parts, MeshTextures& textures);
std::optional<MeshParts> MeshFromBytes(std::string_view bytes, const MeshTextures& textures);

/// A material with `texture`, multiplied by `tint`.
MeshSkin::Material TexturedMaterial(std::shared_ptr<const Image> texture, const std::array<double, 3>& tint);

}  // namespace coopdyn
