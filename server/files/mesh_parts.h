// SPDX-License-Identifier: MIT
// The content of a mesh's file, before anything is computed of it, and its bytes. Pure; any thread.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

inline constexpr std::size_t kMaxMeshTriangles = 200'000;    // of one mesh: a larger one is reduced to these
inline constexpr std::size_t kMaxReadTriangles = 2'000'000;  // of a file
inline constexpr double kMaxVertex_m = 1e4;                  // from the origin, along each axis

struct MeshParts {
  std::vector<Vector3> vertices;  // in the frame of the file
  std::vector<MeshData::Triangle> triangles;
  std::optional<std::array<double, 3>> color;
  std::shared_ptr<const MeshSkin> skin;  // null: `color` all over
};

/// The parts in numbers and an order that their bytes keep.
MeshParts Settled(MeshParts parts);

/// The pictures on meshes, each once.
using MeshTextures = std::vector<std::shared_ptr<const Image>>;

/// The bytes of parts, and back; nothing for bad bytes, of which some more zeros may follow. They name
/// pictures by their places in `textures`, where MeshToBytes() puts those that are not there yet.
std::string MeshToBytes(const MeshParts& parts, MeshTextures& textures);
std::optional<MeshParts> MeshFromBytes(std::string_view bytes, const MeshTextures& textures);

/// The material that a texture makes: multiplied by `tint`.
MeshSkin::Material TexturedMaterial(std::shared_ptr<const Image> texture, const std::array<double, 3>& tint);

}  // namespace coopdyn
