// SPDX-License-Identifier: MIT
// Every fidelity meets walls, things and other robots; and each other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

#include "tests/server/physics/physics_scene.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

class Push : public testing::TestWithParam<std::tuple<Fidelity, int>> {
 protected:
  Push() {
    scene.fidelity = std::get<0>(GetParam());
    scene.step_length = std::get<1>(GetParam()) * 1'000'000;
  }
  PhysicsScene scene;
};

TEST_P(Push, ARobotStopsAtAWallWithinTwoMillimetres) {
  scene.AddRobot(0, 0).Add(Box{Vector3(0.1, 20, 0.5)}, At(1, 0, 0.25)).SetVelocity(0, 0.5, 0);
  for (int i = 0; i < 400; ++i) {
    scene.Run(1);
    ASSERT_LT(scene.robot(0).p.x(), 0.95 - 0.18 + 0.002) << i;
    ASSERT_LT(TiltOf(scene.robot(0)), 0.02);
  }
  scene.RunFor(2);
  EXPECT_NEAR(scene.robot(0).p.x(), 0.95 - 0.18, 0.002);
}

TEST_P(Push, ASlantedWallDeflects) {
  scene.AddRobot(0, 0).Add(Box{Vector3(0.1, 20, 0.5)}, {{1, 0, 0.25}, FromRollPitchYaw(0, 0, 0.6)});
  scene.SetVelocity(0, 0.3, 0);
  const Vector3 normal(std::cos(0.6), std::sin(0.6), 0);
  for (int i = 0; i < 60; ++i) {
    scene.RunFor(0.1);
    ASSERT_LT((scene.robot(0).p - Vector3(1, 0, 0)).dot(normal), -0.05 - 0.18 + 0.002);
    ASSERT_NEAR(scene.robot(0).p.z(), 0, 2e-3);  // the impact makes it pitch
  }
}

TEST_P(Push, ARobotPushesABoxOfAKilogram) {
  scene.AddRobot(0, 0).Add(Box{Vector3(0.3, 0.3, 0.3)}, At(0.5, 0, 0.15), 1, 0.4).SetVelocity(0, 0.2, 0);
  scene.RunFor(6);
  const double gap = scene.object(0).p.x() - scene.robot(0).p.x() - 0.18 - 0.15;
  // Pushed at one point the box may turn, but the two do not overlap.
  EXPECT_GT(gap, -0.003);
  EXPECT_LT(gap, 0.07);
  EXPECT_GT(scene.object(0).p.x(), 1.2);
  EXPECT_NEAR(scene.object(0).p.z(), 0.15, 0.001);
  EXPECT_NEAR(scene.robot(0).p.z(), 0, 1e-3);
}

TEST_P(Push, TwoRobotsHeadOnHoldEachOther) {
  scene.AddRobot(-0.5, 0).AddRobot(0.5, 0, std::numbers::pi);
  scene.SetVelocity(0, 0.3, 0);
  scene.SetVelocity(1, 0.3, 0);
  for (int i = 0; i < 50; ++i) {
    scene.RunFor(0.1);
    ASSERT_GT((scene.robot(0).p - scene.robot(1).p).norm(), 0.36 - 0.002);
    ASSERT_LT(TiltOf(scene.robot(0)), 0.02);
  }
  EXPECT_NEAR((scene.robot(0).p - scene.robot(1).p).norm(), 0.36, 0.002);
  EXPECT_LT(scene.robot(0).p.x(), scene.robot(1).p.x());
}

TEST_P(Push, AParkedRobotIsPushedAheadAgainstItsBrakes) {
  scene.AddRobot(0, 0).AddRobot(0.5, 0, 1.2).AddRobot(0.5, 3).AddRobot(0, 3);
  scene.SetVelocity(3, 0.2, 0);
  scene.RunFor(1);
  const Vector3 before = scene.robot(1).p;
  EXPECT_EQ(before.x(), 0.5);
  scene.RunFor(9);
  EXPECT_GE(scene.robot(2).p.x() - scene.robot(3).p.x(), 0.36 - 0.002);
}

TEST_P(Push, LeavingAWallIsAsFreeAsEver) {
  scene.AddRobot(0.5, 0).Add(Box{Vector3(0.1, 20, 0.5)}, At(1, 0, 0.25)).SetVelocity(0, 0.5, 0);
  scene.RunFor(3);
  scene.SetVelocity(0, -0.5, 0);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(10);
  EXPECT_NEAR(scene.robot(0).p.x() - start.p.x(), -5, 1e-3);
  EXPECT_NEAR(scene.robot(0).p.y(), start.p.y(), 5e-3);
  EXPECT_NEAR(scene.robot(0).p.z(), 0, 1e-4);
}

TEST_P(Push, AWheelSpeedIsThatOfTheMotion) {
  scene.AddRobot(0, 0).Add(Box{Vector3(0.1, 20, 0.5)}, At(1.5, 0, 0.25)).SetVelocity(0, 0.3, 0);
  scene.RunFor(2);
  EXPECT_NEAR(SpeedsOf(*scene.Capture(), 0)[0], 4, 1e-3);
  scene.RunFor(5);  // the motors stall at the wall before the wheels would slip
  EXPECT_NEAR(SpeedsOf(*scene.Capture(), 0)[0], 0, 0.01);
  EXPECT_NEAR(AnglesOf(*scene.Capture(), 0)[1], (scene.robot(0).p.x()) / 0.075, 0.2);
}

std::string PushName(const testing::TestParamInfo<std::tuple<Fidelity, int>>& info) {
  const std::array<std::string, 3> names{"full", "rolling", "planar"};
  const auto [fidelity, step_ms] = info.param;
  return names[static_cast<std::size_t>(fidelity)] + std::to_string(step_ms) + "ms";
}

INSTANTIATE_TEST_SUITE_P(Fidelities, Push,
                         testing::Combine(testing::Values(Fidelity::kFull, Fidelity::kRolling,
                                                          Fidelity::kPlanar),
                                          testing::Values(1, 10, 20)),
                         PushName);

TEST(MixedFidelities, PushEachOtherAlike) {
  PhysicsScene scene;
  for (int i = 0; i < 3; ++i) {
    scene.fidelity = static_cast<Fidelity>(i);
    scene.AddRobot(-0.5, 2 * i);
    scene.fidelity = static_cast<Fidelity>((i + 1) % 3);
    scene.AddRobot(0.5, 2 * i, std::numbers::pi);
  }
  for (int i = 0; i < 6; ++i) scene.SetVelocity(i, 0.3, 0);
  scene.RunFor(5);
  for (int i = 0; i < 6; i += 2) {
    EXPECT_NEAR((scene.robot(i).p - scene.robot(i + 1).p).norm(), 0.36, 0.003) << i;
    // Equal motors: neither pushes the other away at nearly its own speed (1.5 m).
    EXPECT_NEAR(scene.robot(i).p.x() + scene.robot(i + 1).p.x(), 0, 0.5) << i;
  }
}

TEST(Rolling, DrivesOffABoxAndLandsUprightOnTheFloor) {
  PhysicsScene scene;
  scene.fidelity = Fidelity::kRolling;
  const double top = 0.03;
  scene.Add(Box{Vector3(2, 2, top)}, At(0, 0, top / 2)).AddRobot(At(0, 0, top));
  scene.SetVelocity(0, 0.5, 0);
  scene.RunFor(6);
  EXPECT_GT(scene.robot(0).p.x(), 2);
  EXPECT_NEAR(scene.robot(0).p.z(), 0, 1e-6);
  EXPECT_LT(TiltOf(scene.robot(0)), 1e-6);
}

TEST(Rolling, TippedOverStaysTippedOver) {
  PhysicsScene scene;
  scene.fidelity = Fidelity::kRolling;
  scene.AddRobot({{0, 0, 0.3}, FromRollPitchYaw(1.7, 0, 0)});
  scene.SetVelocity(0, 0.5, 0);
  scene.RunFor(5);
  EXPECT_GT(TiltOf(scene.robot(0)), 1.2);
}

TEST(Rolling, SlidesOnIceAsFarAsFrictionLetsIt) {
  PhysicsScene scene;
  scene.fidelity = Fidelity::kRolling;
  scene.SetFloorFriction(0.05).AddRobot(0, 0).SetVelocity(0, 1, 0);
  scene.RunFor(1);
  // The wheels carry half of the weight: 0.05 · 9.81 / 2 m/s² for one second; the wheels spin.
  EXPECT_NEAR(scene.Capture()->bodies[0].v_WB.x(), 0.05 * 9.81 / 2, 0.01);
  EXPECT_NEAR(SpeedsOf(*scene.Capture(), 0)[0], 1 / 0.075, 1e-9);
}

TEST(Rolling, MotorTorqueBoundsTheAcceleration) {
  PhysicsScene scene;
  scene.fidelity = Fidelity::kRolling;
  scene.step_length = 1'000'000;
  scene.AddRobot(0, 0).SetVelocity(0, 1, 0);
  scene.RunFor(0.2);
  EXPECT_NEAR(scene.Capture()->bodies[0].v_WB.x(), 0.2 * (2 / 0.075) / 10, 0.01);
}

TEST(Planar, KeepsItsPlaneUnderALoad) {
  PhysicsScene scene;
  scene.fidelity = Fidelity::kPlanar;
  scene.AddRobot(0, 0).Add(Box{Vector3(0.2, 0.2, 0.1)}, At(0, 0, 0.31), 3).RunFor(3);
  EXPECT_EQ(scene.robot(0).p.z(), 0);
  EXPECT_LT(TiltOf(scene.robot(0)), 1e-9);
  EXPECT_NEAR(scene.object(0).p.z(), 0.31, 1e-3);
}

TEST(Swarm, FiveThousandRobotsBuildAndStep) {
  PhysicsScene scene;
  scene.robot_model = SmallRobot();
  for (int i = 0; i < 5000; ++i) {
    scene.fidelity = static_cast<Fidelity>(i % 3);
    scene.AddRobot(0.5 * (i % 71), 0.5 * (i / 71), 0.1 * i);
  }
  scene.Build();
  ASSERT_TRUE(scene.built());
  for (int i = 0; i < 5000; ++i) scene.SetVelocity(i, 0.05, 0);
  scene.RunFor(0.1);
  const auto frame = scene.Capture();
  for (int i = 0; i < 5000; ++i) ASSERT_NEAR(RobotPose(*frame, i).p.z(), 0, 1e-3);
}

}  // namespace
}  // namespace coopdyn
