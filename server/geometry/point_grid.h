// SPDX-License-Identifier: MIT
// A uniform grid of points in the plane, for things of similar size: each lies in the cell of its centre, and
// queries are enlarged by the things' radius. The cells of a row are adjacent in memory, so a query of a few
// rows reads a few runs. Each build rebuilds the whole grid (counting sort, no allocation once warm).
// Thread-safe between builds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/uniform_grid.h"

namespace coopdyn {

/// A point in the horizontal plane, m.
struct Point2 {
  double x = 0, y = 0;
};

class PointGrid {
 public:
  /// Sorts `points` into cells of side `min_cell_m`, or larger if that would make many more cells than
  /// points. Afterwards order()[k] is the index of the point at position k; within a cell, indices increase.
  /// Non-finite points go to some cell at the edge.
  /// @pre min_cell_m > 0
  void Build(std::span<const Point2> points, double min_cell_m);

  std::span<const std::uint32_t> order() const { return order_; }
  double cell_m() const { return cell_m_; }

  /// Calls visit(first, end) for runs of positions that together hold every point within `box`, and others
  /// nearby, once each.
  template <typename Visit>
  void ForRuns(const Aabb2& box, Visit visit) const {
    if (order_.empty()) return;
    const int x0 = Column(box.min_x), x1 = Column(box.max_x);
    const int y1 = Row(box.max_y);
    for (int y = Row(box.min_y); y <= y1; ++y) VisitRun(y, x0, x1, visit);
  }

  /// The same for the points within `margin_m` (in x and in y) of the segment from `from` that extends
  /// length_m() times `direction`, a vector of length at most 1. Visits runs from the segment's start on;
  /// length_m() may shrink between runs.
  template <typename Length, typename Visit>
  void ForRunsAlong(const Point2& from, const Point2& direction, double margin_m, Length length_m,
                    Visit visit) const;

 private:
  int Column(double x) const { return Clamp((x - min_x_) * cells_per_m_, columns_); }
  int Row(double y) const { return Clamp((y - min_y_) * cells_per_m_, rows_); }
  /// Returns a valid index for every double.
  static int Clamp(double cell, int count) {
    return cell >= count ? count - 1 : cell > 0 ? static_cast<int>(cell) : 0;
  }
  template <typename Visit>
  void VisitRun(int row, int x0, int x1, Visit& visit) const {
    const std::size_t start = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const std::uint32_t first = starts_[start + static_cast<std::size_t>(x0)];
    const std::uint32_t end = starts_[start + static_cast<std::size_t>(x1) + 1];
    if (first < end) visit(first, end);
  }

  double min_x_ = 0, min_y_ = 0, cell_m_ = 1, cells_per_m_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> starts_;  // each cell's first position in order_, then the end
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> cells_;  // of each point, while building
};

template <typename Length, typename Visit>
void PointGrid::ForRunsAlong(const Point2& from, const Point2& direction, double margin_m, Length length_m,
                             Visit visit) const {
  if (order_.empty()) return;
  const int step = direction.y < 0 ? -1 : 1;
  const int first_row = Row(from.y - step * margin_m);
  for (int row = first_row;; row += step) {
    const double length = length_m();
    const double end_y = from.y + length * direction.y;
    const int last_row = Row(end_y + step * margin_m);
    if ((last_row - row) * step < 0) return;
    // Find the part of the segment within the margin of this row. Edge rows also hold the points beyond them,
    // so the segment is not cut there.
    double t0 = 0, t1 = length;
    const double slope = direction.y * step;
    if (slope > 1e-9) {
      const double low = min_y_ + row * cell_m_, high = low + cell_m_;
      const double slack = margin_m + 1e-9 * cell_m_;
      const double enter = step > 0 ? low - slack - from.y : from.y - (high + slack);
      const double leave = step > 0 ? high + slack - from.y : from.y - (low - slack);
      const bool first = step > 0 ? row == 0 : row == rows_ - 1;
      const bool last = step > 0 ? row == rows_ - 1 : row == 0;
      if (!first && enter > 0) t0 = enter / slope;
      if (!last && leave < length * slope) t1 = leave / slope;
    }
    if (t0 <= t1) {
      const double xa = from.x + t0 * direction.x, xb = from.x + t1 * direction.x;
      VisitRun(row, Column((xa < xb ? xa : xb) - margin_m), Column((xa < xb ? xb : xa) + margin_m), visit);
    }
    if (row == last_row) return;
  }
}

}  // namespace coopdyn
