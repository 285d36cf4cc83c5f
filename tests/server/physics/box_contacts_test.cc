// SPDX-License-Identifier: MIT
// Complements pairs_test.cc, which compares boxes with brute force.
#include "server/physics/box_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace coopdyn {
namespace {

constexpr double kMargin_m = 2e-4;

std::vector<ContactPoint> Touch(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB) {
  Part of_a, of_b;
  of_a.shape = a;
  of_b.shape = b;
  const auto state = [](const Pose& X) {
    BodyState body;
    body.p_WB = X.p;
    Orient(body, X.q);
    return body;
  };
  const BodyState at_a = state(X_WA), at_b = state(X_WB);
  const PlacedPart placed_a(of_a, at_a), placed_b(of_b, at_b);
  return BoxContacts(a, placed_a.place(), b, placed_b.place(), kMargin_m);
}

const Box kDie{{0.1, 0.1, 0.1}};

Pose DieAt(double x, double y, double z, double roll = 0, double pitch = 0, double yaw = 0) {
  return {{x, y, z}, FromRollPitchYaw(roll, pitch, yaw)};
}

TEST(BoxContacts, FacesTouchAtFourCorners) {
  const auto points = Touch(kDie, DieAt(0.02, 0, 0.0999), kDie, DieAt(0, 0, 0));
  ASSERT_EQ(points.size(), 4u);
  for (const ContactPoint& point : points) {
    EXPECT_NEAR(point.depth_m, 1e-4, 1e-12);
    EXPECT_LT((point.n_W - Vector3::UnitZ()).norm(), 1e-12);
    EXPECT_NEAR(std::abs(point.p_W.y()), 0.05, 1e-12);
    EXPECT_GT(point.p_W.x(), -0.03 - 1e-12);
    EXPECT_LT(point.p_W.x(), 0.05 + 1e-12);
  }
}

TEST(BoxContacts, KeepsAllFourWhereOneEdgeHasLiftedALittle) {
  const double lean = 1e-3;  // 0.1 mm from one edge to the other
  const auto points = Touch(kDie, DieAt(0, 0, 0.1, lean), kDie, DieAt(0, 0, 0));
  ASSERT_EQ(points.size(), 4u);
  EXPECT_LT(std::ranges::min(points, {}, &ContactPoint::depth_m).depth_m, -4e-5);
  EXPECT_GT(std::ranges::max(points, {}, &ContactPoint::depth_m).depth_m, 4e-5);
}

TEST(BoxContacts, ATurnedFaceIsCutToEightCorners) {
  const auto points = Touch(kDie, DieAt(0, 0, 0.0999, 0, 0, 0.785), kDie, DieAt(0, 0, 0));
  EXPECT_EQ(points.size(), 8u);
}

TEST(BoxContacts, ACornerTouchesAtOnePoint) {
  // The corner of a cube that stands on it is half of its diagonal below its middle.
  const auto points =
      Touch(kDie, DieAt(0.01, 0.02, 0.05 + 0.0866 - 1e-4, 0.7854, 0.6155, 0), kDie, DieAt(0, 0, 0));
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].depth_m, 1e-4, 1e-5);
  EXPECT_LT((points[0].p_W - Vector3(0.01, 0.02, 0.05)).norm(), 1e-3);
}

TEST(BoxContacts, EdgesThatCrossTouchAtOnePoint) {
  const Box bar{{0.4, 0.1, 0.1}};
  const double half = 0.0707106781;  // of its diagonal
  const auto points = Touch(bar, DieAt(0, 0, 2 * half - 1e-3, 0.785398163, 0, 0), bar,
                            DieAt(0, 0, 0, 0.785398163, 0, 1.570796327));
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].depth_m, 1e-3, 1e-8);
  EXPECT_LT((points[0].n_W - Vector3::UnitZ()).norm(), 1e-8);
  EXPECT_LT((points[0].p_W - Vector3(0, 0, half - 5e-4)).norm(), 1e-6);
}

TEST(BoxContacts, ThoseThatAreApartHaveNone) {
  EXPECT_TRUE(Touch(kDie, DieAt(0, 0, 0.1003), kDie, DieAt(0, 0, 0)).empty());
  EXPECT_FALSE(Touch(kDie, DieAt(0, 0, 0.1001), kDie, DieAt(0, 0, 0)).empty());
}

}  // namespace
}  // namespace coopdyn
