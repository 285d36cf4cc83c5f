// SPDX-License-Identifier: MIT
// Clips a mesh's surface to boxes of grid cells. Immutable; thread-safe.
#pragma once

#include <span>
#include <vector>

#include "server/geometry/cell_cuts.h"
#include "server/geometry/cell_grid.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

/// True if the triangles are not an axis-aligned sheet, so that the cells of a CellGrid have some thickness.
bool IsThick(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles);

class SurfaceClip {
 public:
  /// All arguments must outlive the object.
  SurfaceClip(const CellGrid& grid, std::span<const Vector3> vertices,
              std::span<const MeshData::Triangle> triangles);

  /// The corners of the hull of the solid within the boxes. ConvexHull() makes a solid of them: a sheet gets
  /// a thickness of 1 mm. Empty if the boxes hold next to nothing.
  std::vector<Vector3> CornersIn(std::span<const CellBox> boxes) const;

 private:
  void AddPoints(const CellBox& box, std::vector<Vector3>& points, Vector3& behind) const;

  const CellGrid& grid_;
  std::span<const Vector3> vertices_;
  std::span<const MeshData::Triangle> triangles_;
  std::vector<Vector3> behind_;  // CellGrid::Behind() of each triangle
};

}  // namespace coopdyn
