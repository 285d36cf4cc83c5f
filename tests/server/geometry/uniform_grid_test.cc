// SPDX-License-Identifier: MIT
#include "server/geometry/uniform_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace coopdyn {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

bool Overlap(const Aabb2& a, const Aabb2& b) {
  return a.min_x <= b.max_x && b.min_x <= a.max_x && a.min_y <= b.max_y && b.min_y <= a.max_y;
}

Pairs AllPairs(const std::vector<Aabb2>& boxes) {
  Pairs pairs;
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
      if (Overlap(boxes[a], boxes[b])) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

Pairs GridPairs(const std::vector<Aabb2>& boxes, double cell_m) {
  UniformGrid grid;
  grid.Build(boxes, cell_m);
  Pairs pairs;
  grid.FindPairs(boxes, pairs);
  return pairs;
}

/// Boxes in an area of `side_m`, from points to `largest_m`.
std::vector<Aabb2> RandomBoxes(unsigned seed, int count, double side_m, double largest_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-side_m / 2, side_m / 2), size(0, 1);
  std::vector<Aabb2> boxes;
  for (int i = 0; i < count; ++i) {
    const double x = at(random), y = at(random);
    const double w = largest_m * std::pow(size(random), 4), h = largest_m * std::pow(size(random), 4);
    boxes.push_back({x, y, x + w, y + h});
  }
  return boxes;
}

TEST(UniformGrid, FindsExactlyThePairsThatAllPairsFind) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (const double cell_m : {0.1, 0.5, 3.0}) {
      const auto boxes = RandomBoxes(seed, 120, 10, 6);
      ASSERT_EQ(GridPairs(boxes, cell_m), AllPairs(boxes)) << "seed " << seed << " cell " << cell_m;
    }
  }
}

TEST(UniformGrid, LargeItemsAreKeptApartAndStillPaired) {
  auto boxes = RandomBoxes(1, 100, 30, 0.5);
  boxes.insert(boxes.begin() + 40, {-20, -20, 20, 20});
  boxes.push_back({-15, -15, 18, 18});
  UniformGrid grid;
  grid.Build(boxes, 0.5);
  ASSERT_EQ(grid.large_items().size(), 2u);
  EXPECT_EQ(grid.large_items()[0], 40u);
  EXPECT_EQ(GridPairs(boxes, 0.5), AllPairs(boxes));
}

TEST(UniformGrid, BoxesThatOnlyTouchArePaired) {
  EXPECT_EQ(GridPairs({{0, 0, 1, 1}, {1, 1, 2, 2}}, 0.5), (Pairs{{0, 1}}));
}

TEST(UniformGrid, FindOverlapsFindsWhatEveryBoxComparedFinds) {
  auto boxes = RandomBoxes(3, 150, 10, 5);
  boxes.push_back({-30, -30, 30, 30});
  UniformGrid grid;
  grid.Build(boxes, 0.5);
  for (const Aabb2& query : RandomBoxes(4, 100, 14, 6)) {
    std::vector<std::uint32_t> expected, found;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      if (Overlap(query, boxes[i])) expected.push_back(i);
    }
    grid.FindOverlaps(boxes, query, found);
    ASSERT_EQ(found, expected);
  }
}

TEST(UniformGrid, CellsHoldTheItemsThatTouchThemInOrder) {
  const std::vector<Aabb2> boxes = {{0, 0, 2.5, 0.5}, {1.2, 0, 1.4, 0.4}, {0, 2.2, 0.1, 2.3}};
  UniformGrid grid;
  grid.Build(boxes, 1);
  EXPECT_EQ(grid.columns(), 3);
  EXPECT_EQ(grid.rows(), 3);
  const auto cell = [&](int x, int y) {
    const auto items = grid.Cell(x, y);
    return std::vector<std::uint32_t>(items.begin(), items.end());
  };
  EXPECT_EQ(cell(0, 0), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(cell(1, 0), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(cell(2, 0), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(cell(0, 2), (std::vector<std::uint32_t>{2}));
  EXPECT_TRUE(cell(1, 1).empty());
}

TEST(UniformGrid, EmptyGridHasNoPairs) {
  EXPECT_TRUE(GridPairs({}, 1).empty());
  UniformGrid grid;
  grid.Build({}, 1);
  std::vector<std::uint32_t> found;
  grid.FindOverlaps({}, {0, 0, 1, 1}, found);
  EXPECT_TRUE(found.empty());
}

TEST(UniformGrid, CellGrowsWhenTheBoxesLieFarApart) {
  std::vector<Aabb2> boxes = {
      {-1e6, 0, -1e6 + 1, 1}, {1e6, 1e6, 1e6 + 1, 1e6 + 1}, {1e6, 1e6, 1e6 + 2, 1e6 + 1}};
  UniformGrid grid;
  grid.Build(boxes, 0.5);
  EXPECT_LE(static_cast<std::int64_t>(grid.columns()) * grid.rows(), UniformGrid::kMaxCells);
  EXPECT_EQ(GridPairs(boxes, 0.5), AllPairs(boxes));
  boxes.push_back({-1e300, -1e300, 1e300, 1e300});
  boxes.push_back({1e300, 1e300, 1e301, 1e301});
  EXPECT_EQ(GridPairs(boxes, 0.5), AllPairs(boxes));
}

TEST(UniformGrid, RebuildingForgetsWhatWasThere) {
  UniformGrid grid;
  grid.Build(RandomBoxes(1, 50, 10, 3), 0.5);
  const std::vector<Aabb2> boxes = {{0, 0, 1, 1}, {5, 5, 6, 6}};
  grid.Build(boxes, 0.5);
  Pairs pairs;
  grid.FindPairs(boxes, pairs);
  EXPECT_TRUE(pairs.empty());
}

}  // namespace
}  // namespace coopdyn
