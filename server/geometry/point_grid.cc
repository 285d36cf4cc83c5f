// SPDX-License-Identifier: MIT
#include "server/geometry/point_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coopdyn {

namespace {

constexpr double kCellsPerPoint = 2;
constexpr double kSpareCells = 64;
// Points beyond this go to the cells at the edge, so that no sum overflows.
constexpr double kReach_m = 1e9;

}  // namespace

void PointGrid::Build(std::span<const Point2> points, double min_cell_m) {
  order_.resize(points.size());
  if (points.empty()) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double min_x = kInfinity, min_y = kInfinity, max_x = -kInfinity, max_y = -kInfinity;
  for (const Point2& p : points) {
    min_x = std::min(min_x, p.x);
    min_y = std::min(min_y, p.y);
    max_x = std::max(max_x, p.x);
    max_y = std::max(max_y, p.y);
  }
  min_x_ = std::clamp(min_x, -kReach_m, kReach_m);
  min_y_ = std::clamp(min_y, -kReach_m, kReach_m);
  const double length_x = std::clamp(max_x, -kReach_m, kReach_m) - min_x_;
  const double length_y = std::clamp(max_y, -kReach_m, kReach_m) - min_y_;
  const double max_cells = kCellsPerPoint * static_cast<double>(points.size()) + kSpareCells;
  cell_m_ = std::max(min_cell_m, std::sqrt(length_x * length_y / max_cells));
  const auto cells = [this](double length) { return std::floor(length / cell_m_) + 1; };
  while (cells(length_x) * cells(length_y) > 2 * max_cells) cell_m_ *= 1.5;
  cells_per_m_ = 1 / cell_m_;
  columns_ = static_cast<int>(cells(length_x));
  rows_ = static_cast<int>(cells(length_y));

  starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  cells_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto cell = static_cast<std::uint32_t>(Row(points[i].y) * columns_ + Column(points[i].x));
    cells_[i] = cell;
    ++starts_[cell];
  }
  // Set starts_ to each cell's end. Filling from the last point backwards turns ends into starts and keeps
  // points in increasing order.
  std::uint32_t end = 0;
  for (std::uint32_t& start : starts_) start = end += start;
  for (std::size_t i = points.size(); i-- > 0;) order_[--starts_[cells_[i]]] = static_cast<std::uint32_t>(i);
}

}  // namespace coopdyn
