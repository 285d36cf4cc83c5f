// SPDX-License-Identifier: MIT
// A robot moves like an ideal differential drive, at every step size.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "server/model/readers.h"
#include "tests/server/physics/physics_scene.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

TEST(Drive, StraightTenMetresWithinAPercent) {
  PhysicsScene scene;
  scene.AddRobot(0, 0, 0.5).SetVelocity(0, 0.5, 0);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(20);
  const Vector3 moved = scene.robot(0).p - start.p;
  EXPECT_NEAR(moved.x(), 10 * std::cos(0.5), 0.01);
  EXPECT_NEAR(moved.y(), 10 * std::sin(0.5), 0.01);
}

TEST(Drive, CircleOfTwoMetresForThirtySecondsWithinAPercent) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).SetVelocity(0, 0.5, 0.25);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  const double heading = Heading(start.q), turned = 0.25 * 30;
  const Vector3 ideal = start.p + 2 * Vector3(std::sin(heading + turned) - std::sin(heading),
                                              std::cos(heading) - std::cos(heading + turned), 0);
  scene.RunFor(30);
  EXPECT_LT((scene.robot(0).p - ideal).norm(), 0.01 * 2);
  EXPECT_NEAR(WrapAngle(Heading(scene.robot(0).q) - heading - turned), 0, 0.01);
}

TEST(Drive, SpinsOnTheSpotAtTheCommandedRate) {
  PhysicsScene scene;
  scene.AddRobot(1, 2).SetVelocity(0, 0, 2);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(10);
  EXPECT_NEAR(WrapAngle(Heading(scene.robot(0).q) - Heading(start.q) - 20), 0, 0.01);
  EXPECT_LT((scene.robot(0).p - start.p).norm(), 0.01);
}

TEST(Drive, StaysAtRestForAMinute) {
  PhysicsScene scene;
  scene.AddRobot(3, -4, 1).RunFor(60);
  EXPECT_LT((scene.robot(0).p - Vector3(3, -4, 0)).norm(), 1e-3);
  EXPECT_NEAR(Heading(scene.robot(0).q), 1, 1e-3);
}

TEST(Drive, WheelsReportAngleAndSpeedAsTurned) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).SetWheels(0, 3, 4);
  scene.RunFor(1);
  const auto before_rad = AnglesOf(*scene.Capture(), 0);
  scene.RunFor(2);
  const auto after = scene.Capture();
  EXPECT_NEAR(SpeedsOf(*after, 0)[0], 3, 1e-3);
  EXPECT_NEAR(SpeedsOf(*after, 0)[1], 4, 1e-3);
  EXPECT_NEAR(AnglesOf(*after, 0)[0] - before_rad[0], 6, 1e-2);
  EXPECT_NEAR(AnglesOf(*after, 0)[1] - before_rad[1], 8, 1e-2);
  EXPECT_EQ(SetpointOf(*after, 0), (WheelSpeeds{3, 4}));
}

TEST(Drive, MotorTorqueBoundsTheAcceleration) {
  // 2 · 1 N·m / 0.075 m on 10 kg and the wheels' own inertia: 2 J / r² = 0.5 kg.
  PhysicsScene scene;
  scene.step_length = 1'000'000;
  scene.AddRobot(0, 0).SetVelocity(0, 1, 0);
  scene.RunFor(0.2);
  EXPECT_NEAR(scene.Capture()->bodies[0].v_WB.x(), 0.2 * (2 / 0.075) / 10.5, 0.01);
}

class DriveAtStep : public testing::TestWithParam<int> {};

TEST_P(DriveAtStep, IsStableAndAccurate) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  scene.AddRobot(0, 0).SetVelocity(0, 0.5, 0);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(4);
  EXPECT_NEAR(scene.robot(0).p.x() - start.p.x(), 2, 0.02);
  EXPECT_NEAR(scene.robot(0).p.y(), 0, 0.005);
  EXPECT_NEAR(scene.robot(0).p.z(), 0, 1e-3);
  EXPECT_LT(TiltOf(scene.robot(0)), 0.01);
}

TEST_P(DriveAtStep, StaysUprightThroughFullBrakingAndTurning) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  scene.AddRobot(0, 0);
  for (const auto& [left, right] :
       std::vector<std::array<double, 2>>{{14, 14}, {-14, -14}, {14, -14}, {0, 0}}) {
    scene.SetWheels(0, left, right);
    scene.RunFor(0.5);
    EXPECT_LT(TiltOf(scene.robot(0)), 0.1);
  }
  scene.RunFor(1);
  EXPECT_LT(TiltOf(scene.robot(0)), 0.01);
  EXPECT_TRUE(scene.world().TakeFrozen().empty());
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, DriveAtStep, testing::Values(1, 5, 10, 20, 50, 100));

TEST(Drive, OneLongSubstepIsStableToo) {
  PhysicsScene scene;
  scene.step_length = 50'000'000;
  scene.substeps = 1;
  scene.AddRobot(0, 0).SetVelocity(0, 0.5, 0.25);
  scene.RunFor(10);
  EXPECT_NEAR(scene.robot(0).p.z(), 0, 1e-3);
  EXPECT_LT(TiltOf(scene.robot(0)), 0.01);
}

TEST(Drive, TheShippedRobotDrivesAsItsModelSays) {
  Diagnostics diagnostics;
  PhysicsScene scene;
  scene.robot_model = ReadRobotModel(SourceDir() + "/robots/coopbot/model.sdf", SearchPath{}, diagnostics);
  ASSERT_TRUE(scene.robot_model) << diagnostics.ToString();
  const DriveModel& drive = *scene.robot_model->drive();
  scene.AddRobot(0, 0);
  scene.RunFor(60);
  EXPECT_LT(scene.robot(0).p.norm(), 1e-3);
  scene.SetWheels(0, 6, 7);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  const double turned = 30 * drive.wheel_radius_m / drive.track_m;
  const double radius = 6.5 * drive.track_m;
  const double heading = Heading(start.q);
  const Vector3 ideal = start.p + radius * Vector3(std::sin(heading + turned) - std::sin(heading),
                                                   std::cos(heading) - std::cos(heading + turned), 0);
  scene.RunFor(30);
  EXPECT_LT((scene.robot(0).p - ideal).norm(), 0.01 * radius);
  EXPECT_NEAR(WrapAngle(Heading(scene.robot(0).q) - heading - turned), 0, 0.01);
}

TEST(Drive, SubstepsDivideAStepIntoPartsOfAtMostTenMilliseconds) {
  EXPECT_EQ(DefaultSubsteps(500'000), 1);
  EXPECT_EQ(DefaultSubsteps(10'000'000), 1);
  EXPECT_EQ(DefaultSubsteps(10'001'000), 2);
  EXPECT_EQ(DefaultSubsteps(50'000'000), 5);
  EXPECT_EQ(DefaultSubsteps(100'000'000), 10);
}

}  // namespace
}  // namespace coopdyn
