// SPDX-License-Identifier: MIT
// The grid of discs finds exactly the same pairs as a full search.
#include "server/physics/broad_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace coopdyn {
namespace {

std::vector<CircleGrid::Pair> AllPairs(const std::vector<Circle>& circles) {
  std::vector<CircleGrid::Pair> pairs;
  for (std::uint32_t a = 0; a < circles.size(); ++a) {
    for (std::uint32_t b = a + 1; b < circles.size(); ++b) {
      const double dx = circles[a].x - circles[b].x, dy = circles[a].y - circles[b].y;
      const double reach = circles[a].radius_m + circles[b].radius_m;
      if (dx * dx + dy * dy <= reach * reach) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

std::vector<Circle> RandomCircles(std::mt19937& random, int count, double side_m, double smallest_m,
                                  double largest_m) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Circle> circles;
  for (int i = 0; i < count; ++i) {
    circles.push_back({uniform(-side_m, side_m), uniform(-side_m, side_m), uniform(smallest_m, largest_m)});
  }
  return circles;
}

TEST(CircleGrid, FindsWhatAllPairsFind) {
  std::mt19937 random(1);
  CircleGrid grid;
  std::vector<CircleGrid::Pair> pairs;
  std::size_t found = 0;
  for (int round = 0; round < 60; ++round) {
    const double side_m = std::pow(10, round % 4) * 0.3, largest_m = round % 3 == 0 ? 0.1 : 0.3;
    const auto circles = RandomCircles(random, 1 + 7 * round, side_m, 0.1, largest_m);
    grid.FindPairs(circles, pairs);
    EXPECT_EQ(pairs, AllPairs(circles)) << "round " << round;
    found += pairs.size();
  }
  EXPECT_GT(found, 5000u);
}

TEST(CircleGrid, LargeOnesAmongSmallOnesAndOnesFarAway) {
  std::mt19937 random(2);
  CircleGrid grid;
  std::vector<CircleGrid::Pair> pairs;
  for (int round = 0; round < 20; ++round) {
    auto circles = RandomCircles(random, 200, 3, 0.05, 0.1);
    circles[17].radius_m = 2;
    circles[50].radius_m = 1;
    circles[3] = {1e9, -1e9, 0.1};
    circles[4] = {1e9, -1e9 + 0.15, 0.1};
    circles[5] = {1e300, 0, 0.1};
    grid.FindPairs(circles, pairs);
    EXPECT_EQ(pairs, AllPairs(circles)) << "round " << round;
  }
}

TEST(CircleGrid, TouchingAtTheEdgeOfACellCounts) {
  CircleGrid grid;
  std::vector<CircleGrid::Pair> pairs;
  for (int k = 0; k < 1000; ++k) {
    const double x = -50 + 0.1 * k;
    const std::vector<Circle> circles{{x, 0, 0.5}, {x + 1, 0, 0.5}, {x, 1, 0.5}, {x, -1, 0.5}};
    grid.FindPairs(circles, pairs);
    EXPECT_EQ(pairs, AllPairs(circles)) << x;
  }
}

TEST(CircleGrid, NoneAndOneHaveNoPairs) {
  CircleGrid grid;
  std::vector<CircleGrid::Pair> pairs{{1, 2}};
  grid.FindPairs({}, pairs);
  EXPECT_TRUE(pairs.empty());
  const std::vector<Circle> one{{1, 2, 3}};
  grid.FindPairs(one, pairs);
  EXPECT_TRUE(pairs.empty());
}

}  // namespace
}  // namespace coopdyn
