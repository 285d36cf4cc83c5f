// SPDX-License-Identifier: MIT
// Triangles at random positions.
#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

/// `count` triangles of up to 0.8 m within 4 m.
inline MeshData TriangleSoup(std::mt19937& random, int count) {
  std::uniform_real_distribution<> place(-2, 2), size(-0.4, 0.4);
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    const Vector3 at(place(random), place(random), place(random));
    for (int k = 0; k < 3; ++k) vertices.push_back(at + Vector3(size(random), size(random), size(random)));
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  Vector3 middle;
  return MakeMesh(std::move(vertices), std::move(triangles), middle);
}

}  // namespace coopdyn
