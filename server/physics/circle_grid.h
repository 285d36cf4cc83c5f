// SPDX-License-Identifier: MIT
// Which circles in the plane overlap: the robots of a crowd. Rebuilt whole each time (counting sort, no
// allocation once warm). One thread.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace coopdyn {

struct Circle {
  double x = 0, y = 0, radius_m = 0;
};

/// A grid that wraps around like a torus, so that robots far away cost no cells. Each circle lies in the cell
/// of its centre; a cell is as wide as the largest diameter, so that only neighbours need a look.
class CircleGrid {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// Replaces `pairs` by every pair (a < b) of circles that overlap, each once, in increasing order. Circles
  /// that are not finite overlap nothing.
  void FindPairs(std::span<const Circle> circles, std::vector<Pair>& pairs);

 private:
  struct Item {
    double x, y, radius_m;
    std::uint32_t index;
  };
  void Sort(std::span<const Circle> circles);

  double small_m_ = 0;          // circles beyond this radius are tested against all
  int columns_ = 0, rows_ = 0;  // powers of two
  std::vector<std::uint32_t> starts_, cells_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> large_;
};

}  // namespace coopdyn
