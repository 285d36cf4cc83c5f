// SPDX-License-Identifier: MIT
// Fewer triangles for meshes that have too many. Pure; any thread.
#pragma once

#include <cstddef>
#include <string>

#include "server/files/mesh_parts.h"

namespace coopdyn {

struct ReducedMesh {
  MeshParts parts;
  double moved_m = 0;  // no vertex moved further
};

/// `parts` with at most `most` triangles: of the vertices in each cell of a grid the one furthest from the
/// middle stands for all, so that the hull stays. Rossignac, Borrel, "Multi-resolution 3D approximations for
/// rendering complex scenes", 1993, section 3. @pre good indices, finite vertices, most > 0
ReducedMesh Reduce(MeshParts parts, std::size_t most);

/// The warning about a mesh that had `count` triangles.
std::string ReductionText(std::size_t count, const ReducedMesh& reduced);

}  // namespace coopdyn
