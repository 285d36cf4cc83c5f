// SPDX-License-Identifier: MIT
// Convex decomposition that also reports why it gave up. Pure; any thread.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/convex_parts.h"

namespace coopdyn {

struct ConvexCut {
  std::vector<std::vector<Vector3>> parts;  // as from ConvexParts()
  /// True if there are no parts because the triangles intersect in millions of cells, which would take long.
  bool is_tangled = false;
};

/// Uses a grid of about `cells` cells at most: fewer cells are coarser and faster.
/// @pre see ConvexParts()
ConvexCut CutConvex(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                    int most, int cells = kPartCells);

}  // namespace coopdyn
