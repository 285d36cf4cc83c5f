// SPDX-License-Identifier: MIT
// ConvexParts(), and whether it gave up. Pure; any thread.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/convex_parts.h"

namespace coopdyn {

struct ConvexCut {
  std::vector<std::vector<Vector3>> parts;  // as of ConvexParts()
  /// There are none because the triangles run through each other in millions of cells, which would take long.
  bool is_tangled = false;
};

/// With a grid of at most some `cells`: fewer see less, and take less time.
/// @pre as of ConvexParts()
ConvexCut CutConvex(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                    int most, int cells = kPartCells);

}  // namespace coopdyn
