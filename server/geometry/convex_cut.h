// SPDX-License-Identifier: MIT
// ConvexParts(), and whether it gave up. Pure; any thread.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

struct ConvexCut {
  std::vector<std::vector<Vector3>> parts;  // as of ConvexParts()
  /// There are none because the triangles run through each other in millions of cells, which would take long.
  bool is_tangled = false;
};

/// @pre as of ConvexParts()
ConvexCut CutConvex(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                    int most);

}  // namespace coopdyn
