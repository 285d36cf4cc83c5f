// SPDX-License-Identifier: MIT
// Voxels of a mesh's solid, on its surface or inside. Immutable; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

/// A grid of cells around a mesh. Its planes pass through the mesh's large axis-aligned faces, so that shapes
/// made of blocks are exact.
class CellGrid {
 public:
  using Place = std::array<int, 3>;

  /// Makes about `most_cells` cells at most.
  /// @pre valid indices, finite vertices, which do not all lie in one axis-aligned plane
  CellGrid(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles, int most_cells);

  /// True if the triangles touch millions of cells. The grid is then incomplete.
  bool is_tangled() const;

  int count(std::size_t axis) const { return static_cast<int>(planes_[axis].size()) - 1; }
  /// The coordinate of plane `i` in 0 … count(): in m in the vertices' frame, and in whole units of unit_m()
  /// from the lowest plane, at most kLatticeSide.
  double plane_m(std::size_t axis, int i) const { return planes_[axis][static_cast<std::size_t>(i)]; }
  std::int64_t plane(std::size_t axis, int i) const { return lattice_[axis][static_cast<std::size_t>(i)]; }
  double unit_m() const { return unit_m_; }

  /// True if the cell is on the surface or inside. A surface with holes as wide as a cell has no inside.
  bool IsSolid(const Place& cell) const { return cells_[Index(cell)] != Cell::kOutside; }
  /// True if the crossing of three planes is inside the solid: one of the adjacent cells is inside and not on
  /// the surface.
  bool IsCornerWithin(const Place& corner) const;

  /// The shift that moves a triangle behind its surface, so that a triangle in a plane belongs to the cells
  /// behind it. 0 for a degenerate triangle, which its neighbours cover.
  Vector3 Behind(const Vector3& a, const Vector3& b, const Vector3& c) const;
  static constexpr double kBehind = 4;  // units

 private:
  enum class Cell : std::uint8_t { kUnknown, kOutside, kSurface };

  std::size_t Index(const Place& cell) const {
    return (static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(count(1)) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(count(2)) +
           static_cast<std::size_t>(cell[2]);
  }
  void PlacePlanes(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                   int most_cells);
  void MarkSurface(const std::array<Vector3, 3>& corners);
  void MarkOutside();
  /// The cells that overlap the open interval: the first, and one past the last.
  std::pair<int, int> CellsIn(std::size_t axis, double low, double high) const;
  /// The same for a polygon's extent along the axis, shortened by `in` at both ends.
  std::pair<int, int> CellsOf(std::size_t axis, std::span<const Vector3> polygon, double in) const;

  double unit_m_ = 0;
  std::array<std::vector<double>, 3> planes_;
  std::array<std::vector<std::int64_t>, 3> lattice_;
  std::vector<Cell> cells_;                      // once complete, kUnknown means inside
  std::size_t looks_ = 0;                        // cells visited while marking the surface
  std::vector<Vector3> slab_, strip_, scratch_;  // buffers of MarkSurface()
};

}  // namespace coopdyn
