// SPDX-License-Identifier: MIT
// Triangles of centred unit shapes: a box of side 1, a cylinder of diameter and length 1 along z, a sphere of
// diameter 1. All share one pair of buffers. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace coopdyn {

/// Round shapes have several levels of detail: the number is their segments around the axis.
enum class MeshId { kBox, kCylinder8, kCylinder16, kCylinder40, kSphere8, kSphere16, kSphere32, kCount };
inline constexpr std::size_t kMeshCount = static_cast<std::size_t>(MeshId::kCount);

struct MeshVertex {
  std::array<float, 3> position;
  std::array<float, 3> normal;
};

struct MeshRange {
  std::uint32_t first_index = 0;
  std::uint32_t count = 0;
};

struct Meshes {
  std::vector<MeshVertex> vertices;
  std::vector<std::uint16_t> indices;  // counter-clockwise from outside
  std::array<MeshRange, kMeshCount> ranges;
};

Meshes MakeMeshes();

}  // namespace coopdyn
