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

constexpr std::uint32_t kNoOwner = 0xffffffff;

double BruteForce(const std::vector<RayItem>& items, const Ray& ray, double max_range_m,
                  std::uint32_t ignored) {
  double nearest = kNoHit;
  for (const RayItem& item : items) {
    if (item.owner == ignored) continue;
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
    item.owner = static_cast<std::uint32_t>(random.Int(10));
    items.push_back(std::move(item));
  }
  return items;
}

TEST(RayGridTest, EqualsBruteForceOnRandomWorlds) {
  Random random;
  int hits = 0, rays = 0;
  for (const double cell_m : {0.1, 0.5, 1.0, 7.0}) {
    std::vector<RayItem> items = RandomItems(random, 60, 8);
    // Once with the items of an owner together, which makes them one in the grid.
    if (cell_m == 0.5) {
      std::stable_sort(items.begin(), items.end(),
                       [](const auto& a, const auto& b) { return a.owner < b.owner; });
    }
    const RayGrid grid(items, cell_m);
    for (int i = 0; i < 2000; ++i) {
      const double angle = random.Uniform(-std::numbers::pi, std::numbers::pi);
      Ray ray{{random.Uniform(-12, 12), random.Uniform(-12, 12), random.Uniform(0, 0.6)},
              Vector3(std::cos(angle), std::sin(angle), random.Uniform(-0.2, 0.2)).normalized()};
      const double range_m = random.Uniform(0.5, 20);
      const auto ignored = static_cast<std::uint32_t>(random.Int(10));
      const double expected = BruteForce(items, ray, range_m, ignored);
      ASSERT_EQ(grid.Cast(ray, range_m, ignored).distance_m, expected) << "cell " << cell_m << " ray " << i;
      ++rays;
      hits += expected < kNoHit;
    }
  }
  EXPECT_GT(hits, rays / 10);  // else nothing was compared
  EXPECT_LT(hits, rays);
}

TEST(RayGridTest, EqualsBruteForceAlongCellBorders) {
  Random random;
  std::vector<RayItem> items = RandomItems(random, 20, 4);
  // The grid's lower corner is that of the outermost item: a box whose corner is at whole metres.
  items.push_back({Box{{0.5, 0.5, 0.5}}, {-5.75, -5.75, 0.25}, Matrix3::Identity(), 1});
  const RayGrid grid(items, 1.0);
  const Vector3 directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (const Vector3& direction : directions) {
    for (int line = -7; line <= 7; ++line) {
      const Vector3 across(std::abs(direction.y()), std::abs(direction.x()), 0);
      const Ray ray{across * line - 9 * direction + Vector3(0, 0, 0.25), direction};
      EXPECT_EQ(grid.Cast(ray, 30, kNoOwner).distance_m, BruteForce(items, ray, 30, kNoOwner));
    }
  }
}

TEST(RayGridTest, FindsItemsTooLargeForTheCells) {
  std::vector<RayItem> items{{Box{{1000, 1000, 0.1}}, {0, 0, -1}, Matrix3::Identity(), 3}};
  const RayGrid grid(items, 0.5);
  const RayHit hit = grid.Cast({{2, 3, 1}, -Vector3::UnitZ()}, 10, kNoOwner);
  EXPECT_NEAR(hit.distance_m, 1.95, 1e-12);
  EXPECT_EQ(hit.owner, 3U);
}

TEST(RayGridTest, VerticalRayWithoutRangeLimitEnds) {
  const RayGrid grid(
      {{Sphere{0.5}, {0, 0, 5}, Matrix3::Identity(), 1}, {Sphere{0.5}, {9, 9, 0}, Matrix3::Identity(), 1}});
  EXPECT_NEAR(grid.Cast({{0, 0, 0}, Vector3::UnitZ()}, kNoHit, kNoOwner).distance_m, 4.5, 1e-12);
  EXPECT_FALSE(grid.Cast({{3, 3, 0}, Vector3::UnitZ()}, kNoHit, kNoOwner));
}

TEST(RayGridTest, AHitAtExactlyTheRangeCounts) {
  const RayGrid grid({{Box{{1, 1, 1}}, {2.5, 0, 0}, Matrix3::Identity(), 1}});
  EXPECT_EQ(grid.Cast({Vector3::Zero(), Vector3::UnitX()}, 2, kNoOwner).distance_m, 2);
  EXPECT_FALSE(grid.Cast({Vector3::Zero(), Vector3::UnitX()}, 1.999, kNoOwner));
}

TEST(RayGridTest, AnEmptyGridHitsNothing) {
  EXPECT_FALSE(RayGrid({}).Cast({Vector3::Zero(), Vector3::UnitX()}, 100, kNoOwner));
}

}  // namespace
}  // namespace coopdyn
