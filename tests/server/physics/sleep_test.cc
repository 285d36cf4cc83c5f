// SPDX-License-Identifier: MIT
// Resting bodies sleep and wake by whole islands.
#include <gtest/gtest.h>

#include "server/physics/rest.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

const Box kCrate{Vector3(0.3, 0.3, 0.3)};

bool Sleeps(const BodyState& body) {
  return body.sleep_counter == kAsleep;
}
const BodyState& RobotBody(PhysicsScene& scene, int robot) {
  const auto frame = scene.Capture();
  return frame
      ->bodies[static_cast<std::size_t>(frame->scene->robots[static_cast<std::size_t>(robot)].first_body)];
}

class SleepOf : public testing::TestWithParam<Fidelity> {};

TEST_P(SleepOf, AParkedRobotSleepsAfterHalfASecondExactlyAtRest) {
  PhysicsScene scene;
  scene.fidelity = GetParam();
  scene.AddRobot(0, 0).RunFor(0.3);
  EXPECT_FALSE(Sleeps(RobotBody(scene, 0)));
  scene.RunFor(0.7);
  ASSERT_TRUE(Sleeps(RobotBody(scene, 0)));
  EXPECT_EQ(RobotBody(scene, 0).v_WB, Vector3::Zero());
  const auto before = scene.Capture();
  scene.RunFor(10);
  const auto after = scene.Capture();
  for (std::size_t i = 0; i < before->bodies.size(); ++i) {
    EXPECT_EQ(before->bodies[i].p_WB, after->bodies[i].p_WB);
    EXPECT_EQ(before->bodies[i].q_WB, after->bodies[i].q_WB);
  }
}

TEST_P(SleepOf, ARobotWakesByItsSetPointsAndDrivesAsIfItHadNeverSlept) {
  PhysicsScene scene;
  scene.fidelity = GetParam();
  scene.AddRobot(0, 0).RunFor(5);
  ASSERT_TRUE(Sleeps(RobotBody(scene, 0)));
  scene.SetVelocity(0, 0.5, 0);
  scene.RunFor(2);
  EXPECT_FALSE(Sleeps(RobotBody(scene, 0)));
  EXPECT_GT(scene.robot(0).p.x(), 0.8);
}

TEST_P(SleepOf, ARobotThatPushesAgainstAWallDoesNotSleep) {
  PhysicsScene scene;
  scene.fidelity = GetParam();
  scene.AddRobot(0, 0).Add(Box{Vector3(0.1, 4, 0.5)}, At(0.4, 0, 0.25)).SetVelocity(0, 0.2, 0);
  scene.RunFor(5);
  EXPECT_FALSE(Sleeps(RobotBody(scene, 0)));
}

TEST_P(SleepOf, ARobotDrivenIntoASleepingRowWakesAllOfIt) {
  PhysicsScene scene;
  scene.fidelity = GetParam();
  scene.AddRobot(-1, 0).AddRobot(1.2509, 0, 1.5);
  for (int i = 0; i < 3; ++i) scene.Add(Cylinder{0.15, 0.3}, At(0.3 + 0.3003 * i, 0, 0.15), 1, 0.2);
  scene.RunFor(2);
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(Sleeps(RobotBody(scene, i)));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(Sleeps(scene.object_body(i)));
  scene.SetVelocity(0, 0.3, 0);
  scene.RunFor(3.6);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(Sleeps(scene.object_body(i))) << i;
  EXPECT_FALSE(Sleeps(RobotBody(scene, 0)));
  EXPECT_GT(scene.object(2).p.x(), 0.901);
  EXPECT_GT(scene.object(0).p.x() - scene.robot(0).p.x(), 0.33 - 0.002);
}

INSTANTIATE_TEST_SUITE_P(Fidelities, SleepOf,
                         testing::Values(Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar));

TEST(Sleep, AStackSleepsAndWakesTogether) {
  PhysicsScene scene;
  scene.Add(kCrate, At(1, 0, 0.15), 1).Add(kCrate, At(1, 0, 0.45), 1).Add(kCrate, At(1, 0, 0.75), 1);
  scene.AddRobot(0, 0).RunFor(3);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(Sleeps(scene.object_body(i))) << i;
  scene.SetVelocity(0, 0.3, 0);
  scene.RunFor(3);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(Sleeps(scene.object_body(i))) << i;
  EXPECT_GT(scene.object(0).p.x(), 1.05);
}

TEST(Sleep, WhatFallsOnASleeperWakesIt) {
  PhysicsScene scene;
  scene.Add(kCrate, At(0, 0, 0.15), 1).Add(Sphere{0.1}, At(0, 0, 8), 1);
  scene.RunFor(1);
  ASSERT_TRUE(Sleeps(scene.object_body(0)));
  bool woke = false;
  for (int i = 0; i < 100; ++i) {
    scene.Run(1);
    woke = woke || !Sleeps(scene.object_body(0));
  }
  EXPECT_TRUE(woke);
  EXPECT_NEAR(scene.object(1).p.z(), 0.4, 0.005);
}

TEST(Sleep, AMovingIslandKeepsItsRestingMembersAwake) {
  // The box in the robot's way rests on nothing that moves; the one that the robot pushes moves.
  PhysicsScene scene;
  scene.AddRobot(0, 0).Add(kCrate, At(0.4, 0, 0.15), 1).SetVelocity(0, 0.1, 0);
  for (int i = 0; i < 30; ++i) {
    scene.RunFor(0.1);
    if (i <= 10) continue;
    ASSERT_FALSE(Sleeps(scene.object_body(0)));
  }
}

TEST(Sleep, ASleeperThatIsTouchedInANearMissStaysAsleep) {
  PhysicsScene scene;
  scene.fidelity = Fidelity::kRolling;
  scene.AddRobot(0, 0).AddRobot(-1, 0.365).RunFor(1);
  scene.SetVelocity(1, 0.5, 0);
  scene.RunFor(4);
  EXPECT_GT(scene.robot(1).p.x(), 0.8);
  EXPECT_TRUE(Sleeps(RobotBody(scene, 0)));
  EXPECT_EQ(scene.robot(0).p, Vector3::Zero());
}

TEST(Sleep, TheCounterIsInTheHash) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).RunFor(0.2);
  Frame frame;
  frame.scene = scene.world().scene().scenario ? scene.Capture()->scene : nullptr;
  scene.world().Fill(frame);
  const std::uint64_t hash = StateHash(frame);
  ++frame.bodies[0].sleep_counter;
  EXPECT_NE(StateHash(frame), hash);
}

}  // namespace
}  // namespace coopdyn
