// SPDX-License-Identifier: MIT
// A mesh of a model in the driver's memory. Use and destroy it on the context's thread while the context is
// current.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/geometry/mesh.h"
#include "server/render/gl_objects.h"

namespace coopdyn {

/// Flat-shaded; triangles are grouped by material.
struct GlMesh {
  struct Range {
    std::uint32_t material = 0;
    std::size_t first = 0;
    GLsizei count = 0;
  };

  GlMesh(const GlApi& gl, const MeshData& mesh);

  GlVertices vertices, indices, coordinates;
  std::vector<Range> ranges;
  const GLsizei count;
};

}  // namespace coopdyn
