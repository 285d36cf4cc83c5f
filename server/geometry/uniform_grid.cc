// SPDX-License-Identifier: MIT
#include "server/geometry/uniform_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace coopdyn {

namespace {

// Boxes beyond this go to the cells at the edge, so that no sum overflows.
constexpr double kFurthest_m = 1e12;

}  // namespace

void UniformGrid::Build(std::span<const Aabb2> boxes, double cell_m) {
  large_.clear();
  items_.clear();
  cell_m_ = cell_m;
  columns_ = rows_ = 0;
  starts_.assign(1, 0);
  if (boxes.empty()) return;

  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Aabb2 all{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (const Aabb2& box : boxes) {
    all.min_x = std::min(all.min_x, box.min_x);
    all.min_y = std::min(all.min_y, box.min_y);
    all.max_x = std::max(all.max_x, box.max_x);
    all.max_y = std::max(all.max_y, box.max_y);
  }
  min_x_ = std::clamp(all.min_x, -kFurthest_m, kFurthest_m);
  min_y_ = std::clamp(all.min_y, -kFurthest_m, kFurthest_m);
  const double length_x = std::clamp(all.max_x, -kFurthest_m, kFurthest_m) - min_x_;
  const double length_y = std::clamp(all.max_y, -kFurthest_m, kFurthest_m) - min_y_;
  const auto cells = [this](double length) { return std::floor(length / cell_m_) + 1; };
  while (cells(length_x) * cells(length_y) > kMaxCells) cell_m_ *= 2;
  columns_ = static_cast<int>(cells(length_x));
  rows_ = static_cast<int>(cells(length_y));

  const auto is_large = [](const CellRange& r) {
    return std::int64_t{r.x1 - r.x0 + 1} * (r.y1 - r.y0 + 1) > kMaxCellsPerItem;
  };
  starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const CellRange range = Range(boxes[i]);
    if (is_large(range)) {
      large_.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    for (int y = range.y0; y <= range.y1; ++y) {
      for (int x = range.x0; x <= range.x1; ++x) ++starts_[CellIndex(x, y) + 1];
    }
  }
  for (std::size_t cell = 1; cell < starts_.size(); ++cell) starts_[cell] += starts_[cell - 1];
  items_.resize(starts_.back());
  // Filling from the last item backwards turns each cell's end into its start and keeps items in increasing
  // order.
  for (std::size_t i = boxes.size(); i-- > 0;) {
    const CellRange range = Range(boxes[i]);
    if (is_large(range)) continue;
    for (int y = range.y0; y <= range.y1; ++y) {
      for (int x = range.x0; x <= range.x1; ++x) {
        items_[--starts_[CellIndex(x, y) + 1]] = static_cast<std::uint32_t>(i);
      }
    }
  }
  std::rotate(starts_.begin(), starts_.begin() + 1, starts_.end());
  starts_.back() = static_cast<std::uint32_t>(items_.size());
}

void UniformGrid::FindOverlaps(std::span<const Aabb2> boxes, const Aabb2& box,
                               std::vector<std::uint32_t>& items) const {
  const std::size_t first = items.size();
  VisitOverlaps(boxes, box, [&](std::uint32_t item) {
    items.push_back(item);
    return true;
  });
  std::sort(items.begin() + static_cast<std::ptrdiff_t>(first), items.end());
}

void UniformGrid::FindPairs(std::span<const Aabb2> boxes,
                            std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const {
  std::size_t next_large = 0;
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    const std::size_t first = pairs.size();
    while (next_large < large_.size() && large_[next_large] < a) ++next_large;
    if (next_large < large_.size() && large_[next_large] == a) {
      for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
        if (Overlap(boxes[a], boxes[b])) pairs.emplace_back(a, b);
      }
      continue;
    }
    const CellRange range = Range(boxes[a]);
    for (int y = range.y0; y <= range.y1; ++y) {
      for (int x = range.x0; x <= range.x1; ++x) {
        const auto cell = Cell(x, y);
        for (std::size_t k = cell.size(); k-- > 0 && cell[k] > a;) {
          const std::uint32_t b = cell[k];
          if (!Overlap(boxes[a], boxes[b])) continue;
          const CellRange other = Range(boxes[b]);
          if (std::max(range.x0, other.x0) == x && std::max(range.y0, other.y0) == y)
            pairs.emplace_back(a, b);
        }
      }
    }
    for (std::size_t k = next_large; k < large_.size(); ++k) {
      if (Overlap(boxes[a], boxes[large_[k]])) pairs.emplace_back(a, large_[k]);
    }
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end());
  }
}

}  // namespace coopdyn
