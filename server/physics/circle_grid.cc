// SPDX-License-Identifier: MIT
#include "server/physics/circle_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coopdyn {

namespace {

// Circles larger than this many times the smallest do not set the width of cells.
constexpr double kLarge = 4;
constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();

template <typename A, typename B>
bool Meet(const A& a, const B& b) {
  const double dx = a.x - b.x, dy = a.y - b.y, reach = a.radius_m + b.radius_m;
  return dx * dx + dy * dy <= reach * reach;
}

/// A cell number of any size, for any double.
std::int64_t CellNumber(double x) {
  constexpr double kFar = 1e15;
  return static_cast<std::int64_t>(std::floor(x > kFar ? kFar : x > -kFar ? x : -kFar));
}

}  // namespace

void CircleGrid::Sort(std::span<const Circle> circles) {
  double smallest_m = std::numeric_limits<double>::infinity(), widest_m = 0;
  for (const Circle& c : circles) smallest_m = std::min(smallest_m, c.radius_m);
  small_m_ = kLarge * smallest_m;
  for (const Circle& c : circles) {
    if (c.radius_m <= small_m_) widest_m = std::max(widest_m, c.radius_m);
  }
  const double cells_per_m = 1 / std::max(2.001 * widest_m, 1e-3);  // a little wider: rounding
  // Two cells a circle; at least four either way, so that a cell's neighbours differ.
  columns_ = rows_ = 4;
  while (static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) < 2 * circles.size()) {
    (columns_ <= rows_ ? columns_ : rows_) *= 2;
  }
  large_.clear();
  cells_.resize(circles.size());
  starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Circle& c = circles[i];
    if (!(c.radius_m <= small_m_)) {
      large_.push_back(static_cast<std::uint32_t>(i));
      cells_[i] = kNoCell;
      continue;
    }
    const std::int64_t column = CellNumber(c.x * cells_per_m) & (columns_ - 1);
    const std::int64_t row = CellNumber(c.y * cells_per_m) & (rows_ - 1);
    cells_[i] = static_cast<std::uint32_t>(row * columns_ + column);
    ++starts_[cells_[i] + 1];
  }
  for (std::size_t cell = 1; cell < starts_.size(); ++cell) starts_[cell] += starts_[cell - 1];
  items_.resize(starts_.back());
  // From the last circle backwards: turns each cell's end into its start.
  for (std::size_t i = circles.size(); i-- > 0;) {
    if (cells_[i] == kNoCell) continue;
    const Circle& c = circles[i];
    items_[--starts_[cells_[i] + 1]] = {c.x, c.y, c.radius_m, static_cast<std::uint32_t>(i)};
  }
  std::rotate(starts_.begin(), starts_.begin() + 1, starts_.end());
  starts_.back() = static_cast<std::uint32_t>(items_.size());
}

void CircleGrid::FindPairs(std::span<const Circle> circles, std::vector<Pair>& pairs) {
  pairs.clear();
  if (circles.size() < 2) return;
  Sort(circles);
  const auto add = [&pairs](std::uint32_t a, std::uint32_t b) {
    pairs.emplace_back(std::min(a, b), std::max(a, b));
  };
  // Each cell against itself and half of its neighbours.
  for (int row = 0; row < rows_; ++row) {
    const int next_row = ((row + 1) & (rows_ - 1)) * columns_;
    for (int column = 0; column < columns_; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(column);
      const std::uint32_t first = starts_[cell], end = starts_[cell + 1];
      if (first == end) continue;
      const int right = (column + 1) & (columns_ - 1), left = (column - 1) & (columns_ - 1);
      const int neighbours[4] = {row * columns_ + right, next_row + left, next_row + column,
                                 next_row + right};
      for (std::uint32_t i = first; i < end; ++i) {
        const Item& a = items_[i];
        for (std::uint32_t j = i + 1; j < end; ++j) {
          if (Meet(a, items_[j])) add(a.index, items_[j].index);
        }
        for (const int neighbour : neighbours) {
          const std::size_t n = static_cast<std::size_t>(neighbour);
          for (std::uint32_t j = starts_[n]; j < starts_[n + 1]; ++j) {
            if (Meet(a, items_[j])) add(a.index, items_[j].index);
          }
        }
      }
    }
  }
  for (std::size_t k = 0; k < large_.size(); ++k) {
    const std::uint32_t a = large_[k];
    for (std::uint32_t b = 0; b < circles.size(); ++b) {
      const bool also_large = cells_[b] == kNoCell;
      if ((also_large && b <= a) || !Meet(circles[a], circles[b])) continue;
      add(a, b);
    }
  }
  std::sort(pairs.begin(), pairs.end());
}

}  // namespace coopdyn
