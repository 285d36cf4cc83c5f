// SPDX-License-Identifier: MIT
// Robots meet walls, objects and each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

class WallAtHeading : public testing::TestWithParam<double> {};

TEST_P(WallAtHeading, RobotThatDrivesIntoAWallStopsThereAndStaysUpright) {
  PhysicsScene scene;
  scene.AddRobot(0, 0, GetParam()).Add(Box{Vector3(0.1, 20, 0.5)}, At(1, 0, 0.25)).SetVelocity(0, 0.5, 0);
  for (int i = 0; i < 80; ++i) {
    scene.RunFor(0.1);
    ASSERT_LT(scene.robot(0).p.x(), 0.95 - 0.18 + 0.003);
    ASSERT_LT(TiltOf(scene.robot(0)), 0.02);
    ASSERT_NEAR(scene.robot(0).p.z(), 0, 0.002);
  }
  EXPECT_GT(scene.robot(0).p.x(), 0.95 - 0.18 - 0.01);
}

INSTANTIATE_TEST_SUITE_P(Headings, WallAtHeading, testing::Values(0.0, 0.3, -0.7));

TEST(Contact, RobotPushesADynamicBoxAhead) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).Add(Box{Vector3(0.3, 0.3, 0.3)}, At(0.5, 0, 0.15), 1, 0.4).SetVelocity(0, 0.2, 0);
  scene.RunFor(6);
  const double gap = scene.object(0).p.x() - scene.robot(0).p.x() - 0.18 - 0.15;
  EXPECT_NEAR(gap, 0, 0.005);
  EXPECT_GT(scene.object(0).p.x(), 1.2);
  EXPECT_NEAR(scene.object(0).p.z(), 0.15, 0.002);
}

TEST(Contact, WhatLiesParallelOnATiltedBoxOrColumnStaysOnIt) {
  const Box crate{Vector3(0.3, 0.2, 0.2)}, block{Vector3(1, 0.8, 0.5)};
  const Cylinder can{0.1, 0.2}, column{0.5, 0.5};
  struct Case {
    const char* name;
    Shape above, below;
  };
  for (const auto& [name, above, below] :
       {Case{"a crate on a box", crate, block}, Case{"a crate on a column", crate, column},
        Case{"a can on a box", can, block}, Case{"a can on a column", can, column}}) {
    for (int i = 0; i < 60; ++i) {
      const double tilt_rad = (5 + i % 11) * std::numbers::pi / 180, turn_rad = i * std::numbers::pi / 180;
      const Quaternion q = FromRollPitchYaw(0, tilt_rad, turn_rad);
      const Vector3 up = q * Vector3::UnitZ(), middle(0, 0, 2);
      PhysicsScene scene;
      scene.Add(below, Pose{middle, q});
      scene.Add(above, Pose{middle + 0.35 * up + 0.01 * (q * Vector3::UnitX()), q}, 1, 0.8);
      scene.RunFor(0.6);
      EXPECT_NEAR(up.dot(scene.object(1).p - middle), 0.35, 0.001)
          << name << " tilted by " << tilt_rad << ", turned by " << turn_rad;
      EXPECT_LT((scene.object(1).q * Vector3::UnitZ()).cross(up).norm(), 0.01) << name;
    }
  }
}

TEST(Contact, RobotPushesACylinderAndASphere) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).AddRobot(0, 3);
  scene.Add(Cylinder{0.15, 0.3}, At(0.5, 0, 0.15), 1, 0.4).Add(Sphere{0.15}, At(0.5, 3, 0.15), 1);
  scene.SetVelocity(0, 0.2, 0);
  scene.SetVelocity(1, 0.2, 0);
  scene.RunFor(4);
  EXPECT_GT(scene.object(0).p.x(), scene.robot(0).p.x() + 0.18 + 0.15 - 0.005);
  EXPECT_GT(scene.object(1).p.x(), scene.robot(1).p.x() + 0.18 + 0.15 - 0.005);
}

TEST(Contact, TwoRobotsHeadOnHoldEachOther) {
  PhysicsScene scene;
  scene.AddRobot(-0.5, 0).AddRobot(0.5, 0, 3.14159265358979);
  scene.SetVelocity(0, 0.3, 0);
  scene.SetVelocity(1, 0.3, 0);
  scene.RunFor(5);
  EXPECT_NEAR((scene.robot(0).p - scene.robot(1).p).norm(), 0.36, 0.003);
  EXPECT_LT(TiltOf(scene.robot(0)), 0.02);
}

TEST(Contact, WheelsRollOverTheTopOfALowStaticBox) {
  const double top = 0.3;
  PhysicsScene scene;
  scene.Add(Box{Vector3(6, 2, top)}, At(0, 0, top / 2)).AddRobot(At(-2, 0, top));
  scene.SetVelocity(0, 0.5, 0);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(4);
  EXPECT_NEAR(scene.robot(0).p.x() - start.p.x(), 2, 0.01);
  EXPECT_NEAR(scene.robot(0).p.y(), 0, 0.005);
  EXPECT_NEAR(scene.robot(0).p.z(), top, 0.001);
}

TEST(Contact, RobotClimbsARampAtItsWheelsSpeed) {
  const double slope = 0.1;
  const Quaternion q = FromRollPitchYaw(0, -slope, 0);  // rises towards +x
  PhysicsScene scene;
  scene.Add(Box{Vector3(20, 4, 0.2)}, {{0, 0, 2}, q})
      .AddRobot(Pose{Vector3(0, 0, 2) + q * Vector3(-5, 0, 0.1), q});
  scene.SetVelocity(0, 0.4, 0);
  scene.RunFor(2);
  const Pose start = scene.robot(0);
  scene.RunFor(10);
  EXPECT_NEAR((scene.robot(0).p - start.p).dot(q * Vector3::UnitX()), 4, 0.04);
}

TEST(Contact, ThirtyCrowdedRobotsNeitherExplodeNorSinkNorTopple) {
  PhysicsScene scene;
  for (int i = 0; i < 30; ++i) scene.AddRobot(-1 + 0.4 * (i % 6), -0.8 + 0.4 * (i / 6), 0.7 * i);
  const double half = 1.5;  // 0.3 m² a robot
  for (int k = 0; k < 4; ++k) {
    const double angle = k * std::acos(0.0);
    scene.Add(Box{Vector3(0.1, 4, 0.5)},
              {{half * std::cos(angle), half * std::sin(angle), 0.25}, FromRollPitchYaw(0, 0, angle)});
  }
  std::mt19937 random(5);
  for (int second = 0; second < 20; ++second) {
    for (int i = 0; i < 30; ++i) {
      const double left = static_cast<double>(random() % 2001) / 100 - 10;
      scene.SetWheels(i, left, static_cast<double>(random() % 2001) / 100 - 10);
    }
    scene.RunFor(1);
    ASSERT_TRUE(scene.built()) << scene.diagnostics().ToString();
    for (int i = 0; i < 30; ++i) {
      const Pose pose = scene.robot(i);
      ASSERT_LT(TiltOf(pose), 0.2) << "robot" << i + 1 << " at " << second + 1 << " s";
      ASSERT_NEAR(pose.p.z(), 0, 0.01);
      ASSERT_LT(pose.p.head<2>().cwiseAbs().maxCoeff(), half);
    }
  }
  EXPECT_TRUE(scene.world().TakeFrozen().empty());
}

TEST(Contact, RobotsPressedTogetherDoNotSinkIntoEachOther) {
  PhysicsScene scene;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::acos(0.0) / 3;
    scene.AddRobot(1.5 * std::cos(angle), 1.5 * std::sin(angle), angle + 2 * std::acos(0.0));
  }
  for (int i = 0; i < 12; ++i) scene.SetVelocity(i, 0.5, 0);
  scene.RunFor(10);
  for (int a = 0; a < 12; ++a) {
    for (int b = 0; b < a; ++b)
      EXPECT_GT((scene.robot(a).p - scene.robot(b).p).norm(), 0.36 - 0.01) << a << b;
  }
}

}  // namespace
}  // namespace coopdyn
