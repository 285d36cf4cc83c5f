// SPDX-License-Identifier: MIT
#include "server/geometry/ray_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace coopdyn {
namespace {

double BruteForce(const std::vector<RayItem>& items, const Ray& ray, double max_range_m) {
  double nearest = kNoHit;
  for (const RayItem& item : items) {
    const Ray local{item.R_WG.transpose() * (ray.origin - item.p_WG), item.R_WG.transpose() * ray.direction};
    nearest = std::min(nearest, RayToShape(local, item.shape));
  }
  return nearest <= max_range_m ? nearest : kNoHit;
}

class Random {
 public:
  double Uniform(double min, double max) {
    return min + (max - min) * std::uniform_real_distribution<>()(engine_);
  }
  int Int(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }
  Quaternion Rotation() { return FromRollPitchYaw(Uniform(-3, 3), Uniform(-1.5, 1.5), Uniform(-3, 3)); }

 private:
  std::mt19937 engine_{42};
};

std::vector<RayItem> RandomItems(Random& random, int count, double half_area_m) {
  std::vector<RayItem> items;
  for (int i = 0; i < count; ++i) {
    RayItem item;
    const int kind = random.Int(3);
    if (kind == 0)
      item.shape = Box{{random.Uniform(0.05, 3), random.Uniform(0.05, 0.5), random.Uniform(0.1, 1)}};
    if (kind == 1) item.shape = Cylinder{random.Uniform(0.05, 0.6), random.Uniform(0.1, 1)};
    if (kind == 2) item.shape = Sphere{random.Uniform(0.05, 0.6)};
    item.p_WG = {random.Uniform(-half_area_m, half_area_m), random.Uniform(-half_area_m, half_area_m),
                 random.Uniform(0, 0.5)};
    item.R_WG = random.Rotation().toRotationMatrix();
    items.push_back(std::move(item));
  }
  return items;
}

TEST(RayGridTest, EqualsBruteForceOnRandomWorlds) {
  Random random;
  int hits = 0, rays = 0;
  for (const double cell_m : {0.1, 0.5, 1.0, 7.0}) {
    const std::vector<RayItem> items = RandomItems(random, 60, 8);
    const RayGrid grid(items, cell_m);
    for (int i = 0; i < 2000; ++i) {
      const double angle = random.Uniform(-std::numbers::pi, std::numbers::pi);
      Ray ray{{random.Uniform(-12, 12), random.Uniform(-12, 12), random.Uniform(0, 0.6)},
              Vector3(std::cos(angle), std::sin(angle), random.Uniform(-0.2, 0.2)).normalized()};
      const double range_m = random.Uniform(0.5, 20);
      const double expected = BruteForce(items, ray, range_m);
      ASSERT_EQ(grid.Cast(ray, range_m), expected) << "cell " << cell_m << " ray " << i;
      ++rays;
      hits += expected < kNoHit;
    }
  }
  EXPECT_GT(hits, rays / 10);  // otherwise nothing was compared
  EXPECT_LT(hits, rays);
}

TEST(RayGridTest, EqualsBruteForceAlongCellBorders) {
  Random random;
  std::vector<RayItem> items = RandomItems(random, 20, 4);
  // The grid's lower corner is that of the outermost item: a box with a corner at integer metres.
  items.push_back({Box{{0.5, 0.5, 0.5}}, {-5.75, -5.75, 0.25}, Matrix3::Identity()});
  const RayGrid grid(items, 1.0);
  const Vector3 directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (const Vector3& direction : directions) {
    for (int line = -7; line <= 7; ++line) {
      const Vector3 across(std::abs(direction.y()), std::abs(direction.x()), 0);
      const Ray ray{across * line - 9 * direction + Vector3(0, 0, 0.25), direction};
      EXPECT_EQ(grid.Cast(ray, 30), BruteForce(items, ray, 30));
    }
  }
}

TEST(RayGridTest, FindsItemsTooLargeForTheCells) {
  std::vector<RayItem> items{{Box{{1000, 1000, 0.1}}, {0, 0, -1}, Matrix3::Identity()}};
  const RayGrid grid(items, 0.5);
  EXPECT_NEAR(grid.Cast({{2, 3, 1}, -Vector3::UnitZ()}, 10), 1.95, 1e-12);
}

TEST(RayGridTest, VerticalRayWithoutRangeLimitEnds) {
  const std::vector<RayItem> items{{Sphere{0.5}, {0, 0, 5}, Matrix3::Identity()},
                                   {Sphere{0.5}, {9, 9, 0}, Matrix3::Identity()}};
  const RayGrid grid(items);
  EXPECT_NEAR(grid.Cast({{0, 0, 0}, Vector3::UnitZ()}, kNoHit), 4.5, 1e-12);
  EXPECT_EQ(grid.Cast({{3, 3, 0}, Vector3::UnitZ()}, kNoHit), kNoHit);
}

TEST(RayGridTest, AHitAtExactlyTheRangeCounts) {
  const std::vector<RayItem> items{{Box{{1, 1, 1}}, {2.5, 0, 0}, Matrix3::Identity()}};
  const RayGrid grid(items);
  EXPECT_EQ(grid.Cast({Vector3::Zero(), Vector3::UnitX()}, 2), 2);
  EXPECT_EQ(grid.Cast({Vector3::Zero(), Vector3::UnitX()}, 1.999), kNoHit);
}

TEST(RayGridTest, AnEmptyGridHitsNothing) {
  EXPECT_EQ(RayGrid().Cast({Vector3::Zero(), Vector3::UnitX()}, 100), kNoHit);
}

}  // namespace
}  // namespace coopdyn
