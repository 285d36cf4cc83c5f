// SPDX-License-Identifier: MIT
// Contacts by formula: position, normal, depth; and when to use ODE instead.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/physics/closed_forms.h"

namespace coopdyn {
namespace {

/// A pose as ODE keeps it.
struct Placed {
  explicit Placed(const Pose& pose) : p{pose.p.x(), pose.p.y(), pose.p.z()} {
    const Matrix3 m = pose.q.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) R[4 * row + column] = m(row, column);
    }
  }
  PlacedRotation get() const { return {p, R}; }
  double p[3];
  double R[12] = {};
};

Placed PlacedAt(double x, double y, double z, const Quaternion& q = Quaternion::Identity()) {
  return Placed({{x, y, z}, q});
}
const Quaternion kRolling = FromRollPitchYaw(-std::numbers::pi / 2, 0, 0);  // axle along y

TEST(WheelOnFloor, TouchesAtTheLowestPointOfItsTread) {
  const ClosedForm form = WheelOnFloor(0.1, PlacedAt(1, 2, 0.098, kRolling).get());
  ASSERT_TRUE(form.applies && form.contact);
  EXPECT_LT((form.contact->p_W - Vector3(1, 2, -0.002)).norm(), 1e-12);
  EXPECT_NEAR(form.contact->depth_m, 0.002, 1e-12);
  EXPECT_EQ(form.contact->n_W, Vector3::UnitZ());
}

TEST(WheelOnFloor, TiltedWheelTouchesUnderItsRim) {
  const double camber = 0.2;
  const Quaternion q = FromRollPitchYaw(camber, 0, 0) * kRolling;
  const ClosedForm form = WheelOnFloor(0.1, PlacedAt(0, 0, 0.1 * std::cos(camber) - 0.001, q).get());
  ASSERT_TRUE(form.applies && form.contact);
  EXPECT_NEAR(form.contact->p_W.y(), 0.1 * std::sin(camber), 1e-12);
  EXPECT_NEAR(form.contact->depth_m, 0.001, 1e-12);
}

TEST(WheelOnFloor, AboveTheFloorThereIsNoContactAndLyingItDoesNotApply) {
  const ClosedForm above = WheelOnFloor(0.1, PlacedAt(0, 0, 0.1001, kRolling).get());
  EXPECT_TRUE(above.applies);
  EXPECT_FALSE(above.contact);
  EXPECT_FALSE(WheelOnFloor(0.1, PlacedAt(0, 0, 0.01).get()).applies);
}

TEST(WheelOnBox, TouchesTheTopWithinItsRectangleOnly) {
  const Box box{Vector3(1, 1, 0.4)};
  const Placed under = PlacedAt(0, 0, 0.2);
  const ClosedForm on_top = WheelOnBox(0.1, PlacedAt(0.3, 0, 0.499, kRolling).get(), box, under.get());
  ASSERT_TRUE(on_top.applies && on_top.contact);
  EXPECT_NEAR(on_top.contact->depth_m, 0.001, 1e-12);
  EXPECT_FALSE(
      WheelOnBox(0.1, PlacedAt(0.55, 0, 0.45, kRolling).get(), box, under.get()).applies);  // over the edge
  EXPECT_FALSE(WheelOnBox(0.1, PlacedAt(0.3, 0, 0.3, kRolling).get(), box, under.get()).applies);  // within
}

TEST(WheelOnBox, TakesWhicheverFaceIsUp) {
  const Box box{Vector3(0.4, 1, 1)};
  const Placed turned = PlacedAt(0, 0, 0.2, FromRollPitchYaw(0, -std::numbers::pi / 2, 0));
  const ClosedForm form = WheelOnBox(0.1, PlacedAt(0, 0, 0.499, kRolling).get(), box, turned.get());
  ASSERT_TRUE(form.applies && form.contact);
  EXPECT_NEAR(form.contact->n_W.z(), 1, 1e-12);
  EXPECT_NEAR(form.contact->depth_m, 0.001, 1e-9);
}

TEST(UprightCylinders, TouchBetweenTheirAxesAtMiddleHeight) {
  const Cylinder tall{0.2, 1}, low{0.1, 0.4};
  const ClosedForm form =
      UprightCylinders(tall, PlacedAt(0.29, 0, 0.5).get(), low, PlacedAt(0, 0, 0.2).get());
  ASSERT_TRUE(form.applies && form.contact);
  EXPECT_LT((form.contact->p_W - Vector3(0.095, 0, 0.2)).norm(), 1e-12);
  EXPECT_LT((form.contact->n_W - Vector3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(form.contact->depth_m, 0.01, 1e-12);
}

TEST(UprightCylinders, OneOnTopOfTheOtherIsLeftToOde) {
  const Cylinder c{0.2, 0.4};
  EXPECT_FALSE(UprightCylinders(c, PlacedAt(0.1, 0, 0.599).get(), c, PlacedAt(0, 0, 0.2).get()).applies);
  EXPECT_FALSE(UprightCylinders(c, PlacedAt(0.1, 0, 0.6, FromRollPitchYaw(0.2, 0, 0)).get(), c,
                                PlacedAt(0, 0, 0.2).get())
                   .applies);
}

TEST(UprightCylinderAndBox, TouchesFaceAndCornerOfATurnedBox) {
  const Cylinder c{0.2, 0.5};
  const Box box{Vector3(1, 0.5, 0.5)};
  const double yaw = 0.7;
  const Placed turned = PlacedAt(1, 2, 0.25, FromRollPitchYaw(0, 0, yaw));
  const Vector3 x(std::cos(yaw), std::sin(yaw), 0), y(-std::sin(yaw), std::cos(yaw), 0), centre(1, 2, 0.25);
  const Vector3 at_face = centre + 0.69 * x + 0.1 * y;
  const ClosedForm face =
      UprightCylinderAndBox(c, PlacedAt(at_face.x(), at_face.y(), 0.25).get(), box, turned.get());
  ASSERT_TRUE(face.applies && face.contact);
  EXPECT_LT((face.contact->n_W - x).norm(), 1e-9);
  EXPECT_NEAR(face.contact->depth_m, 0.01, 1e-9);
  const Vector3 at_corner = centre + 0.6 * x + 0.35 * y;
  const ClosedForm corner =
      UprightCylinderAndBox(c, PlacedAt(at_corner.x(), at_corner.y(), 0.25).get(), box, turned.get());
  ASSERT_TRUE(corner.applies && corner.contact);
  EXPECT_LT((corner.contact->n_W - (x + y).normalized()).norm(), 1e-9);
  EXPECT_NEAR(corner.contact->depth_m, 0.2 - std::hypot(0.1, 0.1), 1e-9);
}

TEST(UprightCylinderAndBox, CentreInsideTheBoxIsPushedOutOfTheNearestFace) {
  const ClosedForm form = UprightCylinderAndBox(Cylinder{0.1, 2}, PlacedAt(0.45, 0, 1).get(),
                                                Box{Vector3(1, 3, 2)}, PlacedAt(0, 0, 1).get());
  ASSERT_TRUE(form.applies && form.contact);
  EXPECT_LT((form.contact->n_W - Vector3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(form.contact->depth_m, 0.15, 1e-12);
}

TEST(DepthInside, IsTheDistanceToTheNearestSurface) {
  const Placed at = PlacedAt(1, 0, 0, FromRollPitchYaw(0, 0, std::numbers::pi / 2));
  EXPECT_NEAR(DepthInside(Box{Vector3(1, 2, 4)}, at.get(), {1, 0.4, 0}), 0.1, 1e-12);
  EXPECT_NEAR(DepthInside(Cylinder{0.5, 4}, at.get(), {1, 0.3, 0}), 0.2, 1e-12);
  EXPECT_NEAR(DepthInside(Sphere{0.5}, at.get(), {1, 0, 0.7}), -0.2, 1e-12);
}

}  // namespace
}  // namespace coopdyn
