// SPDX-License-Identifier: MIT
// The solid of a mesh in cells: which lie on its surface, which within. Constant once made; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {

/// Cells about a mesh. The planes between them go through its large faces that are square to an
/// axis, so that shapes made of blocks are exact.
class CellGrid {
 public:
  using Place = std::array<int, 3>;

  /// Of at most some `most_cells`.
  /// @pre good indices, finite vertices, not all in one plane that is square to an axis
  CellGrid(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles, int most_cells);

  /// The triangles reach into millions of cells: the grid is not finished.
  bool is_tangled() const;

  int count(std::size_t axis) const { return static_cast<int>(planes_[axis].size()) - 1; }
  /// Where plane `i` of 0 … count() is, in the frame of the vertices, m; and in units of unit_m() from the
  /// lowest: whole numbers of at most kLatticeSide.
  double plane_m(std::size_t axis, int i) const { return planes_[axis][static_cast<std::size_t>(i)]; }
  std::int64_t plane(std::size_t axis, int i) const { return lattice_[axis][static_cast<std::size_t>(i)]; }
  double unit_m() const { return unit_m_; }

  /// On the surface or within. A surface with holes as wide as a cell has nothing within.
  bool IsSolid(const Place& cell) const { return cells_[Index(cell)] != Cell::kOutside; }
  /// The crossing of three planes is within the solid: one of the cells about it is, and not on the surface.
  bool IsCornerWithin(const Place& corner) const;

  /// By how much a triangle is moved to lie behind itself, so that one in a plane belongs to the cells there.
  /// 0 for one that is a line, whose place its neighbours have.
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
  /// The cells that reach into the open interval, first and one past the last.
  std::pair<int, int> CellsIn(std::size_t axis, double low, double high) const;
  /// The same for what of a polygon is more than `in` from its ends.
  std::pair<int, int> CellsOf(std::size_t axis, std::span<const Vector3> polygon, double in) const;

  double unit_m_ = 0;
  std::array<std::vector<double>, 3> planes_;
  std::array<std::vector<std::int64_t>, 3> lattice_;
  std::vector<Cell> cells_;                      // kUnknown in the end: within
  std::size_t looks_ = 0;                        // at cells, to mark the surface
  std::vector<Vector3> slab_, strip_, scratch_;  // of MarkSurface()
};

}  // namespace coopdyn
