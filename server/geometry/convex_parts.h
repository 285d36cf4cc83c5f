// SPDX-License-Identifier: MIT
// A concave solid as convex parts. Pure; any thread.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

inline constexpr int kMostConvexParts = 16;
/// Of the grid.
inline constexpr int kPartCells = 200'000;
/// Of the volume of a solid's hull: with less around the solid it counts as convex.
inline constexpr double kConcave = 0.1;

/// The solid that the triangles enclose as at most `most` convex parts: the corners of each, whose
/// ConvexHull() it is, in the frame of the vertices. Empty if one hull will do: it is hardly larger than the
/// solid, or parts would be hardly better. Also of surfaces with holes. As in K. Mamou (2016), "Volumetric
/// hierarchical approximate convex decomposition", Game Engine Gems 3, a grid of cells is cut by planes again
/// and again where that makes the hulls smallest, and then pieces are joined while their common hull holds
/// little else. The hulls are those of the surface itself between the cuts.
/// @pre good indices, finite vertices
std::vector<std::vector<Vector3>> ConvexParts(std::span<const Vector3> vertices,
                                              std::span<const MeshData::Triangle> triangles,
                                              int most = kMostConvexParts);

}  // namespace coopdyn
