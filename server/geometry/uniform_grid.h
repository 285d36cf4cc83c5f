// SPDX-License-Identifier: MIT
// A uniform grid over boxes in the plane, for the broad phase of physics and the ray casts of sensing.
// Each build rebuilds the whole grid (counting sort, no allocation once warm). Thread-safe between builds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace coopdyn {

/// An axis-aligned box in the horizontal plane, m.
struct Aabb2 {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

class UniformGrid {
 public:
  /// Fills the grid with `boxes`; an item is a box's index. Cells have side `cell_m`, enlarged if the boxes
  /// would need more than `kMaxCells`. Boxes that would cover more than `kMaxCellsPerItem` cells go to
  /// `large_items()` instead.
  /// @pre all numbers finite, cell_m > 0.
  void Build(std::span<const Aabb2> boxes, double cell_m);

  /// Items that touch cell (ix, iy), by increasing index.
  std::span<const std::uint32_t> Cell(int ix, int iy) const {
    const std::size_t cell = CellIndex(ix, iy);
    return std::span(items_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
  }
  std::span<const std::uint32_t> large_items() const { return large_; }

  double min_x() const { return min_x_; }
  double min_y() const { return min_y_; }
  double cell_m() const { return cell_m_; }
  int columns() const { return columns_; }  // along x
  int rows() const { return rows_; }        // along y

  /// Appends every pair (a < b) of items whose boxes overlap, once each, in increasing order of (a, b).
  void FindPairs(std::span<const Aabb2> boxes,
                 std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const;

  /// Appends every item whose box overlaps `box` (which need not be in the grid), once each, by increasing
  /// index. `boxes`: the same as in Build().
  void FindOverlaps(std::span<const Aabb2> boxes, const Aabb2& box, std::vector<std::uint32_t>& items) const;

  /// Calls visit(item) for the same items, once each in no particular order, until it returns false.
  template <typename Visit>
  void VisitOverlaps(std::span<const Aabb2> boxes, const Aabb2& box, Visit visit) const;

  static constexpr int kMaxCells = 1 << 20;
  static constexpr int kMaxCellsPerItem = 1024;

 private:
  static bool Overlap(const Aabb2& a, const Aabb2& b) {
    return a.min_x <= b.max_x && b.min_x <= a.max_x && a.min_y <= b.max_y && b.min_y <= a.max_y;
  }
  /// The cells that a box touches, both ends inclusive.
  struct CellRange {
    int x0, y0, x1, y1;
  };
  CellRange Range(const Aabb2& box) const {
    return {Index(box.min_x, min_x_, columns_), Index(box.min_y, min_y_, rows_),
            Index(box.max_x, min_x_, columns_), Index(box.max_y, min_y_, rows_)};
  }
  /// Returns a valid index for every double.
  int Index(double x, double min, int count) const {
    const double cell = (x - min) / cell_m_;
    return cell >= count ? count - 1 : cell > 0 ? static_cast<int>(cell) : 0;
  }
  std::size_t CellIndex(int ix, int iy) const {
    return static_cast<std::size_t>(iy) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(ix);
  }

  double min_x_ = 0, min_y_ = 0, cell_m_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> starts_;  // each cell's first position in items_, then the end
  std::vector<std::uint32_t> items_;
  std::vector<std::uint32_t> large_;
};

template <typename Visit>
void UniformGrid::VisitOverlaps(std::span<const Aabb2> boxes, const Aabb2& box, Visit visit) const {
  if (boxes.empty()) return;
  const CellRange range = Range(box);
  for (int y = range.y0; y <= range.y1; ++y) {
    // The cells of a row are adjacent, so one comparison shows that all are empty.
    const std::size_t first = CellIndex(range.x0, y);
    const std::size_t end = first + static_cast<std::size_t>(range.x1 - range.x0) + 1;
    if (starts_[first] == starts_[end]) continue;
    for (int x = range.x0; x <= range.x1; ++x) {
      for (const std::uint32_t item : Cell(x, y)) {
        if (!Overlap(box, boxes[item])) continue;
        // Both boxes may share many cells; count only the lowest.
        const CellRange other = Range(boxes[item]);
        if ((range.x0 > other.x0 ? range.x0 : other.x0) != x) continue;
        if ((range.y0 > other.y0 ? range.y0 : other.y0) != y) continue;
        if (!visit(item)) return;
      }
    }
  }
  for (const std::uint32_t item : large_) {
    if (Overlap(box, boxes[item]) && !visit(item)) return;
  }
}

}  // namespace coopdyn
