// SPDX-License-Identifier: MIT
// The convex hull of points, including nearly coplanar ones after rounding to floats.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "server/geometry/mesh.h"

namespace coopdyn {
namespace {

double UpToOne(std::mt19937& bits) {
  return 2.0 * static_cast<double>(bits()) / 4294967295.0 - 1;
}

/// Points of a disc of radius 1 m, rotated and rounded to floats as in files.
std::vector<Vector3> Disc(double thickness_m, unsigned seed) {
  std::mt19937 bits(seed);
  Eigen::Quaterniond turn(UpToOne(bits), UpToOne(bits), UpToOne(bits), UpToOne(bits));
  turn.normalize();
  std::vector<Vector3> points;
  for (int i = 0; i < 4000; ++i) {
    const double angle = std::numbers::pi * UpToOne(bits);
    const Vector3 p(std::cos(angle), std::sin(angle), thickness_m * (i % 2 - 0.5));
    points.push_back((turn * p).cast<float>().cast<double>());
  }
  return points;
}

TEST(ConvexHullTest, OfACubeIsTheCube) {
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  Vector3 middle;
  const auto hull = ConvexHull(corners, middle);
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->vertices.size(), 8u);
  EXPECT_EQ(hull->triangles.size(), 12u);
  EXPECT_NEAR(hull->volume_m3, 1, 1e-12);
  EXPECT_NEAR((middle - Vector3(0.5, 0.5, 0.5)).norm(), 0, 1e-12);
}

TEST(ConvexHullTest, OfPointsInAPlaneThereIsNone) {
  Vector3 middle;
  EXPECT_FALSE(ConvexHull(Disc(0, 1), middle));
}

TEST(ConvexHullTest, RoundingMakesNoMoreFacesThanCornersAllow) {
  for (const double thickness_m : {4e-4, 1e-3, 1e-2, 0.1}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      SCOPED_TRACE(testing::Message() << thickness_m << " m, seed " << seed);
      Vector3 middle;
      const auto hull = ConvexHull(Disc(thickness_m, seed), middle);
      ASSERT_TRUE(hull);
      EXPECT_EQ(hull->triangles.size(), 2 * hull->vertices.size() - 4);  // Euler's formula
      EXPECT_NEAR(hull->volume_m3, std::numbers::pi * thickness_m, 0.02 * std::numbers::pi * thickness_m);
    }
  }
}

}  // namespace
}  // namespace coopdyn
