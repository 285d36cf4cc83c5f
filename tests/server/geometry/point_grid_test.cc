// SPDX-License-Identifier: MIT
#include "server/geometry/point_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace coopdyn {
namespace {

std::vector<Point2> RandomPoints(std::mt19937& engine, int count, double half_m) {
  std::uniform_real_distribution<> place(-half_m, half_m);
  std::vector<Point2> points;
  for (int i = 0; i < count; ++i) {
    const double x = place(engine);
    points.push_back({x, place(engine)});
  }
  return points;
}

/// Receives runs, and counts the visits of each point.
class Taker {
 public:
  explicit Taker(const PointGrid& grid) : grid_(grid), times_(grid.order().size()) {}
  void operator()(std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t k = first; k < end; ++k) ++times_[grid_.order()[k]];
  }
  int times(std::size_t point) const { return times_[point]; }
  int sum() const {
    int sum = 0;
    for (const int times : times_) sum += times;
    return sum;
  }

 private:
  const PointGrid& grid_;
  std::vector<int> times_;
};

TEST(PointGrid, RunsHoldAllPointsOfABoxOnce) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<> place(-12, 12), size(0, 6);
  PointGrid grid;
  int visited = 0, all = 0;
  for (const int count : {1, 2, 30, 1000}) {
    const std::vector<Point2> points = RandomPoints(engine, count, 10);
    grid.Build(points, 0.1);
    for (int trial = 0; trial < 300; ++trial) {
      const double x = place(engine), y = place(engine);
      const Aabb2 box{x, y, x + size(engine), y + size(engine)};
      Taker taker(grid);
      grid.ForRuns(box, [&](auto first, auto end) { taker(first, end); });
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Point2& p = points[i];
        const bool inside = p.x >= box.min_x && p.x <= box.max_x && p.y >= box.min_y && p.y <= box.max_y;
        ASSERT_GE(taker.times(i), inside ? 1 : 0);
        ASSERT_LE(taker.times(i), 1);
      }
      visited += taker.sum();
      all += count;
    }
  }
  EXPECT_LT(visited, all / 4);  // otherwise the grid would not help
}

TEST(PointGrid, RunsAlongASegmentHoldAllPointsNearItOnce) {
  std::mt19937 engine(6);
  std::uniform_real_distribution<> place(-14, 14), length(0, 20), turn(-4, 4), margin(0, 1);
  PointGrid grid;
  int visited = 0, all = 0, near = 0;
  for (const int count : {1, 30, 1000}) {
    const std::vector<Point2> points = RandomPoints(engine, count, 10);
    grid.Build(points, 0.1);
    for (int trial = 0; trial < 400; ++trial) {
      const Point2 from{place(engine), place(engine)};
      const double angle = trial % 8 == 0 ? std::round(turn(engine)) * 1.5707963267948966 : turn(engine);
      const double flat = trial % 5 == 0 ? 0.3 : 1;  // seen from above, a ray may be shorter
      const Point2 direction{flat * std::cos(angle), flat * std::sin(angle)};
      const double length_m = length(engine), margin_m = margin(engine);
      Taker taker(grid);
      grid.ForRunsAlong(
          from, direction, margin_m, [&] { return length_m; },
          [&](auto first, auto end) { taker(first, end); });
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double dx = points[i].x - from.x, dy = points[i].y - from.y;
        const double along = std::clamp((dx * direction.x + dy * direction.y) / (flat * flat), 0.0, length_m);
        const bool is_near = std::hypot(dx - along * direction.x, dy - along * direction.y) <= margin_m;
        ASSERT_GE(taker.times(i), is_near ? 1 : 0) << "trial " << trial << " point " << i;
        ASSERT_LE(taker.times(i), 1);
        near += is_near;
      }
      visited += taker.sum();
      all += count;
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_LT(visited, all / 2);
}

TEST(PointGrid, ARunAlongASegmentEndsWhereTheLengthHasShrunkTo) {
  std::vector<Point2> points;
  for (int i = 0; i < 100; ++i) points.push_back({0, 1.0 * i});
  PointGrid grid;
  grid.Build(points, 0.5);
  double length_m = 99;
  std::uint32_t last = 0;
  grid.ForRunsAlong(
      {0, 0}, {0, 1}, 0.1, [&] { return length_m; },
      [&](std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t k = first; k < end; ++k) last = std::max(last, grid.order()[k]);
        length_m = 10;
      });
  EXPECT_GE(last, 10U);
  EXPECT_LT(last, 20U);
}

TEST(PointGrid, OnePointFarAwayMakesNoMoreCellsThanMemory) {
  std::mt19937 engine(7);
  std::vector<Point2> points = RandomPoints(engine, 100, 5);
  points.push_back({1e12, -1e12});
  PointGrid grid;
  grid.Build(points, 0.1);
  Taker taker(grid);
  grid.ForRuns({1e11, -1e13, 1e13, -1e11}, [&](auto first, auto end) { taker(first, end); });
  EXPECT_EQ(taker.times(100), 1);
}

TEST(PointGrid, PointsOfACellStandByIncreasingIndex) {
  const std::vector<Point2> points(20, {1, 1});
  PointGrid grid;
  grid.Build(points, 1);
  EXPECT_TRUE(std::is_sorted(grid.order().begin(), grid.order().end()));
}

TEST(PointGrid, AnEmptyOneVisitsNothing) {
  PointGrid grid;
  grid.Build({}, 1);
  Taker taker(grid);
  grid.ForRuns({-1, -1, 1, 1}, [&](auto first, auto end) { taker(first, end); });
  grid.ForRunsAlong(
      {0, 0}, {1, 0}, 1, [] { return 1.0; }, [&](auto first, auto end) { taker(first, end); });
  EXPECT_EQ(taker.sum(), 0);
}

}  // namespace
}  // namespace coopdyn
