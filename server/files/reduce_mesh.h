// SPDX-License-Identifier: MIT
// Reduces the number of triangles of large meshes. Pure; any thread.
#pragma once

#include <cstddef>
#include <string>

#include "server/files/mesh_parts.h"

namespace coopdyn {

struct ReducedMesh {
  MeshParts parts;
  double moved_m = 0;  // no vertex moved further
};

/// `parts` with at most `most` triangles. Merges the vertices in each cell of a grid into the one furthest
/// from the centre, which preserves the hull. Rossignac, Borrel, "Multi-resolution 3D approximations for
/// rendering complex scenes", 1993, section 3. @pre valid indices, finite vertices, most > 0
ReducedMesh Reduce(MeshParts parts, std::size_t most);

/// The warning for a mesh that had `count` triangles.
std::string ReductionText(std::size_t count, const ReducedMesh& reduced);

}  // namespace coopdyn
