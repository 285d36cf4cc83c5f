// SPDX-License-Identifier: MIT
// Approximate convex decomposition of concave solids. Pure; any thread.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

inline constexpr int kMostConvexParts = 16;
/// Default number of grid cells.
inline constexpr int kPartCells = 200'000;
/// A solid counts as convex if it leaves at most this fraction of its hull empty.
inline constexpr double kConcave = 0.1;

/// Splits the solid that the triangles enclose into at most `most` convex parts. Returns the corners of each
/// part, whose ConvexHull() is the part, in the vertices' frame. Empty if one hull suffices: it is hardly
/// larger than the solid, or parts would be hardly better. Accepts surfaces with holes. As in K. Mamou
/// (2016), "Volumetric hierarchical approximate convex decomposition", Game Engine Gems 3, planes repeatedly
/// cut a grid of cells where that makes the hulls smallest; then pieces are joined while their common hull
/// holds little else. The returned hulls are those of the surface itself between the cuts.
/// @pre valid indices, finite vertices
std::vector<std::vector<Vector3>> ConvexParts(std::span<const Vector3> vertices,
                                              std::span<const MeshData::Triangle> triangles,
                                              int most = kMostConvexParts);

}  // namespace coopdyn
