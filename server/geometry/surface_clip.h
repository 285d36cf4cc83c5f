// SPDX-License-Identifier: MIT
// The surface of a mesh within boxes of its cells. Constant once made; any thread.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/cell_cuts.h"
#include "server/geometry/cell_grid.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

/// Whether the triangles are more than a sheet, so that a CellGrid has cells of some thickness.
bool IsThick(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles);

class SurfaceClip {
 public:
  /// All outlive it.
  SurfaceClip(const CellGrid& grid, std::span<const Vector3> vertices,
              std::span<const MeshData::Triangle> triangles);

  /// The corners of the hull of the solid in the boxes, of which ConvexHull() makes a solid: a sheet gets
  /// 1 mm of thickness. Empty if there is next to nothing.
  std::vector<Vector3> CornersIn(std::span<const CellBox> boxes) const;

 private:
  void AddPoints(const CellBox& box, std::vector<Vector3>& points, Vector3& behind) const;

  const CellGrid& grid_;
  std::span<const Vector3> vertices_;
  std::span<const MeshData::Triangle> triangles_;
  std::vector<Vector3> behind_;  // by triangle
};

}  // namespace coopdyn
