// SPDX-License-Identifier: MIT
// Objects move by the laws of mechanics. Each tolerance is stated with its test.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

constexpr double kGravity = 9.81;
const Box kCube{Vector3(0.2, 0.2, 0.2)};

TEST(Mechanics, DroppedBoxFallsFreelyAndLandsWithoutBounce) {
  PhysicsScene scene;
  scene.step_length = 1'000'000;
  scene.Add(kCube, At(0, 0, 2.1), 1);
  scene.RunFor(0.5);
  // Semi-implicit Euler is off by g·t·dt/2 = 2.5 mm.
  EXPECT_NEAR(scene.object(0).p.z(), 2.1 - kGravity * 0.25 / 2, 0.003);
  scene.RunFor(1);
  EXPECT_NEAR(scene.object(0).p.z(), 0.1, 0.001);
  EXPECT_LT(scene.object_body(0).v_WB.norm(), 1e-3);
}

class DropAtStep : public testing::TestWithParam<int> {};

TEST_P(DropAtStep, ComesToRestOnTheFloorAndDoesNotRebound) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  scene.Add(kCube, At(0, 0, 0.6), 1);
  scene.RunFor(0.5);
  double highest = 0;
  for (int i = 0; i < 20; ++i) {
    scene.RunFor(0.1);
    highest = std::max(highest, scene.object(0).p.z());
  }
  EXPECT_LT(highest, 0.105);
  EXPECT_NEAR(scene.object(0).p.z(), 0.1, 0.001);
  EXPECT_LT(scene.object_body(0).v_WB.norm(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, DropAtStep, testing::Values(1, 5, 10, 20, 50));

TEST(Mechanics, SphereRollsDownARampWithFiveSeventhsOfTheSlope) {
  const double slope = 0.2, radius = 0.1;
  const Quaternion q = FromRollPitchYaw(0, slope, 0);  // falls towards +x
  PhysicsScene scene;
  scene.Add(Box{Vector3(10, 2, 0.2)}, {{0, 0, 3}, q});
  const Vector3 start = Vector3(0, 0, 3) + q * Vector3(-4, 0, 0.1 + radius);
  scene.Add(Sphere{radius}, {start, Quaternion::Identity()}, 2);
  scene.RunFor(2);
  const double rolled = (scene.object(1).p - start).dot(q * Vector3::UnitX());
  EXPECT_NEAR(rolled, 5.0 / 7 * kGravity * std::sin(slope) * 4 / 2, 0.02 * rolled);
  // It rolls and does not slip.
  EXPECT_NEAR(scene.object_body(1).w_WB.y() * radius, scene.object_body(1).v_WB.norm(), 0.01);
}

class SlideInDirection : public testing::TestWithParam<double> {};

TEST_P(SlideInDirection, BoxStopsAfterSquareOfSpeedOverTwiceFrictionAndGravity) {
  const double speed = 2, friction = 0.4;
  PhysicsScene scene;
  scene.step_length = 2'000'000;
  scene.Add(Box{Vector3(0.3, 0.3, 0.1)}, At(0, 0, 0.05), 1, friction);
  scene.RunFor(0.1);
  Frame frame;
  scene.world().Fill(frame);
  frame.bodies[0].v_WB = speed * Vector3(std::cos(GetParam()), std::sin(GetParam()), 0);
  scene.world().Restore(frame);
  scene.RunFor(2);
  const double stop = speed * speed / (2 * friction * kGravity);
  EXPECT_NEAR(scene.object(0).p.head<2>().norm(), stop, 0.02 * stop);
  EXPECT_LT(scene.object_body(0).v_WB.norm(), 1e-3);
}

// Friction is the same in every direction, not only along the axes of the world.
INSTANTIATE_TEST_SUITE_P(Headings, SlideInDirection, testing::Values(0.0, 0.4, std::numbers::pi / 4));

TEST(Mechanics, TheSlipperierOfTwoDecidesTheFriction) {
  const double slope = 0.3;  // tan = 0.31
  const Quaternion q = FromRollPitchYaw(0, slope, 0);
  PhysicsScene scene;
  scene.Add(Box{Vector3(10, 4, 0.2)}, {{0, 0, 3}, q}, 0, 1);
  const auto on_ramp = [&](double y) { return Pose{Vector3(0, 0, 3) + q * Vector3(-3, y, 0.2), q}; };
  scene.Add(kCube, on_ramp(-1), 1, 0.5).Add(kCube, on_ramp(1), 1, 0.1);
  scene.RunFor(1);
  EXPECT_LT((scene.object(1).p - on_ramp(-1).p).norm(), 0.002);  // holds, and does not creep
  const double slid = kGravity * (std::sin(slope) - 0.1 * std::cos(slope)) / 2;
  EXPECT_NEAR((scene.object(2).p - on_ramp(1).p).norm(), slid, 0.03 * slid);
}

TEST(Mechanics, StackOfEightBoxesStands) {
  PhysicsScene scene;
  for (int i = 0; i < 8; ++i) scene.Add(kCube, At(0, 0, 0.1 + 0.2 * i), 1);
  scene.RunFor(30);
  for (int i = 0; i < 8; ++i) {
    EXPECT_LT((scene.object(i).p - Vector3(0, 0, 0.1 + 0.2 * i)).norm(), 0.001) << i;
  }
}

TEST(Mechanics, RollingSphereKeepsItsSpeed) {
  PhysicsScene scene;
  scene.Add(Sphere{0.1}, At(0, 0, 0.1), 1);
  scene.Build();
  Frame frame;
  scene.world().Fill(frame);
  frame.bodies[0].v_WB = {1, 0, 0};
  frame.bodies[0].w_WB = {0, 10, 0};
  scene.world().Restore(frame);
  scene.RunFor(5);
  EXPECT_NEAR(scene.object(0).p.x(), 5, 0.02);
}

TEST(Mechanics, DynamicThingsRestOnEachOtherWhateverTheirShape) {
  PhysicsScene scene;
  scene.Add(Box{Vector3(1, 1, 0.2)}, At(0, 0, 0.1), 5);
  scene.Add(Cylinder{0.1, 0.3}, At(-0.3, 0, 0.36), 1).Add(kCube, At(0.3, 0, 0.32), 1);
  scene.Add(Cylinder{0.1, 0.3}, At(3, 0, 0.16), 1);
  scene.Add(Cylinder{0.1, 0.3}, {{4, 0, 0.11}, FromRollPitchYaw(std::numbers::pi / 2, 0, 0)}, 1);
  scene.RunFor(5);
  EXPECT_NEAR(scene.object(1).p.z(), 0.35, 0.003);
  EXPECT_NEAR(scene.object(2).p.z(), 0.3, 0.003);
  EXPECT_NEAR(scene.object(3).p.z(), 0.15, 0.003);
  EXPECT_NEAR(scene.object(4).p.z(), 0.1, 0.003);
}

}  // namespace
}  // namespace coopdyn
