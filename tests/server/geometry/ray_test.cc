// SPDX-License-Identifier: MIT
#include "server/geometry/ray.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace coopdyn {
namespace {

constexpr double kTolerance_m = 1e-12;

Ray Towards(const Vector3& origin, const Vector3& direction) {
  return {origin, direction.normalized()};
}

TEST(RayTest, HitsTheNearFaceOfABox) {
  const Box box{{2, 4, 1}};
  EXPECT_NEAR(RayToBox(Towards({-3, 1, 0.2}, {1, 0, 0}), box), 2, kTolerance_m);
  EXPECT_NEAR(RayToBox(Towards({0, 5, 0}, {0, -1, 0}), box), 3, kTolerance_m);
  EXPECT_NEAR(RayToBox(Towards({0, 0, 2}, {0, 0, -1}), box), 1.5, kTolerance_m);
}

TEST(RayTest, HitsABoxAtAnAngle) {
  // From (−3, −2, 0) at 45°: reaches x = −1 at y = 0.
  EXPECT_NEAR(RayToBox(Towards({-3, -2, 0}, {1, 1, 0}), Box{{2, 4, 1}}), 2 * std::numbers::sqrt2,
              kTolerance_m);
}

TEST(RayTest, MissesABoxBesideAndBehind) {
  const Box box{{2, 2, 2}};
  EXPECT_EQ(RayToBox(Towards({-3, 1.5, 0}, {1, 0, 0}), box), kNoHit);
  EXPECT_EQ(RayToBox(Towards({3, 0, 0}, {1, 0, 0}), box), kNoHit);
  EXPECT_EQ(RayToBox(Towards({-3, -3, 0}, {1, -1, 0}), box), kNoHit);
}

TEST(RayTest, HitsTheSideOfACylinder) {
  // Offset y = 0.3 of radius 0.5: the surface lies at x = −0.4.
  EXPECT_NEAR(RayToCylinder(Towards({-2, 0.3, 0}, {1, 0, 0}), Cylinder{0.5, 1}), 1.6, kTolerance_m);
}

TEST(RayTest, HitsTheCapOfACylinder) {
  const Cylinder cylinder{0.5, 1};
  EXPECT_NEAR(RayToCylinder(Towards({0.2, 0.1, 3}, {0, 0, -1}), cylinder), 2.5, kTolerance_m);
  // Descends at 45° and hits the top before the side.
  EXPECT_NEAR(RayToCylinder(Towards({-1, 0, 1.5}, {1, 0, -1}), cylinder), std::numbers::sqrt2, kTolerance_m);
}

TEST(RayTest, MissesACylinderAboveAndBeside) {
  const Cylinder cylinder{0.5, 1};
  EXPECT_EQ(RayToCylinder(Towards({-2, 0, 0.6}, {1, 0, 0}), cylinder), kNoHit);
  EXPECT_EQ(RayToCylinder(Towards({-2, 0.51, 0}, {1, 0, 0}), cylinder), kNoHit);
  EXPECT_EQ(RayToCylinder(Towards({0.6, 0, 3}, {0, 0, -1}), cylinder), kNoHit);
}

TEST(RayTest, HitsASphere) {
  EXPECT_NEAR(RayToSphere(Towards({-2, 0.3, 0}, {1, 0, 0}), Sphere{0.5}), 1.6, kTolerance_m);
  EXPECT_EQ(RayToSphere(Towards({-2, 0.51, 0}, {1, 0, 0}), Sphere{0.5}), kNoHit);
  EXPECT_EQ(RayToSphere(Towards({2, 0, 0}, {1, 0, 0}), Sphere{0.5}), kNoHit);
}

TEST(RayTest, StartingInsideIsZero) {
  const Ray ray = Towards({0.1, 0.2, 0.1}, {1, 2, 3});
  EXPECT_EQ(RayToShape(ray, Box{{1, 1, 1}}), 0);
  EXPECT_EQ(RayToShape(ray, Cylinder{0.5, 1}), 0);
  EXPECT_EQ(RayToShape(ray, Sphere{0.5}), 0);
}

TEST(RayTest, MeetsTheFloorOnlyGoingDown) {
  EXPECT_NEAR(RayToFloor(Towards({1, 2, 0.5}, {1, 0, -1})), 0.5 * std::numbers::sqrt2, kTolerance_m);
  EXPECT_EQ(RayToFloor(Towards({1, 2, 0.5}, {1, 0, 0})), kNoHit);
  EXPECT_EQ(RayToFloor(Towards({1, 2, 0.5}, {1, 0, 0.1})), kNoHit);
  EXPECT_EQ(RayToFloor(Towards({1, 2, -0.1}, {1, 0, 1})), 0);
}

TEST(Ray, ACylinderAboutAnyAxisIsMetWhereItIsInItsOwnFrame) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<> any(-1, 1), size(0.05, 1);
  int hits = 0, inside = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Cylinder cylinder{size(engine), size(engine)};
    const Quaternion q = FromRollPitchYaw(3 * any(engine), 3 * any(engine), 3 * any(engine));
    const Vector3 axis = q * Vector3::UnitZ();
    const Ray ray{1.5 * Vector3(any(engine), any(engine), any(engine)),
                  trial % 10 == 0 ? axis : Vector3(any(engine), any(engine), any(engine)).normalized()};
    const double expected =
        RayToCylinder({q.conjugate() * ray.origin, q.conjugate() * ray.direction}, cylinder);
    const double found = RayToCylinder(ray, cylinder, axis);
    if (expected == kNoHit) {
      ASSERT_EQ(found, kNoHit) << trial;
    } else {
      ASSERT_NEAR(found, expected, 1e-9) << trial;
      (expected == 0 ? inside : hits) += 1;
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace coopdyn
