// SPDX-License-Identifier: MIT
// Contacts of robots with limbs: boxes, crowds, wheeled robots.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::limbs {
namespace {

/// A block fixed to the world, 0.2 m wide and high, with an arm on top that hangs freely.
std::shared_ptr<const RobotModel> Block() {
  RobotModel model;
  model.type = "block";
  model.fixed_base = true;
  LinkModel base, arm;
  base.name = "base";
  base.X_RL.p = {0, 0, 0.1};
  base.mass_kg = 1;
  base.inertia_kg_m2 = Vector3::Constant(0.01);
  base.collisions = {{Box{{0.2, 0.2, 0.2}}, {}, {}, 1, false}};
  arm = base;
  arm.name = "arm";
  arm.X_RL.p = {0, 0, 0.5};
  arm.collisions.clear();
  model.links = {base, arm};
  JointModel joint;
  joint.name = "shoulder";
  joint.child = 1;
  joint.p_RJ = {0, 0, 0.6};
  model.joints = {joint};
  model.footprint_radius_m = 0.2;
  model.height_m = 0.6;
  return std::make_shared<const RobotModel>(std::move(model));
}

/// `count` boxes in a row that starts at the block.
void AddRow(PhysicsScene& scene, int count) {
  scene.robot_model = Block();
  scene.AddRobot(0, 0);
  for (int i = 0; i < count; ++i) scene.Add(Box{{0.1, 0.1, 0.1}}, At(0.15 + 0.1 * i, 0, 0.05), 1);
}

void ExpectRest(PhysicsScene& scene, int count, double within_m) {
  for (int i = 0; i < count; ++i) {
    const Pose X_WO = scene.object(i);
    EXPECT_LT((X_WO.p - Vector3(0.15 + 0.1 * i, 0, 0.05)).norm(), within_m) << i;
    EXPECT_LT(X_WO.q.angularDistance(Quaternion::Identity()), 1e-2) << i;
  }
}

TEST(LimbsTest, AFewBoxesAtAnArmStayAtRest) {
  PhysicsScene scene;
  AddRow(scene, 3);
  scene.RunFor(2);
  ExpectRest(scene, 3, 1e-4);
}

TEST(LimbsTest, MoreBoxesThanAreSolvedDirectlyStayAtRest) {
  PhysicsScene scene;
  AddRow(scene, 20);
  scene.RunFor(2);
  ExpectRest(scene, 20, 3e-3);  // the iterative solver creeps slightly
}

TEST(LimbsTest, ARowThatIsPushedMovesAsOne) {
  // The last box is hit: the block, which is fixed, takes it all.
  PhysicsScene scene;
  AddRow(scene, 12);
  scene.Add(Box{{0.1, 0.1, 0.1}}, At(1.4, 0, 0.05), 1);
  scene.Build();
  auto frame = scene.Capture();
  for (BodyState& body : frame->bodies) body.sleep_counter = 0;
  for (BodyState& body : frame->bodies)
    if (std::abs(body.p_WB.x() - 1.4) < 1e-6) body.v_WB.x() = -1;
  scene.Restore(*frame);
  scene.RunFor(2);
  ExpectRest(scene, 12, 3e-3);
}

TEST(LimbsTest, AWheeledRobotStopsAtAnArm) {
  for (const Fidelity fidelity : {Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar}) {
    PhysicsScene scene;
    scene.fidelity = fidelity;
    scene.AddRobot(0, 0);
    scene.fidelity = Fidelity::kFull;
    scene.robot_model = Block();
    scene.AddRobot(1, 0);
    scene.Build();
    ASSERT_EQ(scene.diagnostics().ToString(), "");
    scene.SetVelocity(0, 0.5, 0);
    scene.RunFor(4);
    const double radius_m = TestRobot()->footprint_radius_m;
    EXPECT_NEAR(scene.robot(0).p.x(), 0.9 - radius_m, 3e-3);
    EXPECT_LT(TiltOf(scene.robot(0)), 0.02);
    // Back again, as straight as without it.
    scene.SetVelocity(0, -0.2, 0);
    scene.RunFor(2);
    EXPECT_NEAR(scene.robot(0).p.y(), 0, 0.01);
    EXPECT_LT(scene.robot(0).p.x(), 0.6 - radius_m);
  }
}

TEST(LimbsTest, ThreadsDoNotChangeABit) {
  std::uint64_t hash = 0;
  for (const int threads : {0, 2, 4}) {
    std::unique_ptr<WorkerPool> pool;
    if (threads > 0) pool = std::make_unique<WorkerPool>(threads);
    PhysicsScene scene;
    scene.pool = pool.get();
    scene.robot_model = Block();
    for (int i = 0; i < 8; ++i) {
      scene.AddRobot(2.0 * i, 0, 0.3 * i);
      scene.Add(Box{{0.1, 0.1, 0.1}}, At(2.0 * i, 0, 0.8 + 0.05 * i), 1);
    }
    scene.RunFor(1);
    const std::uint64_t now = StateHash(*scene.Capture());
    if (threads == 0) hash = now;
    EXPECT_EQ(now, hash) << threads;
  }
}

TEST(LimbsTest, WhatWasNotSolvedExactlyIsCounted) {
  // Chips of 0.1 g under blocks of a thousand tons: 16 digits do not suffice.
  PhysicsScene scene;
  scene.robot_model = Block();
  scene.AddRobot(0, 0);
  for (int i = 0; i < 8; ++i)
    scene.Add(Box{{0.1, 0.1, 0.1}}, At(0.15, 0, 0.05 + 0.1 * i), i % 2 == 0 ? 1e-4 : 1e6);
  scene.RunFor(1);
  const std::vector<std::string> unsolved = scene.world().TakeUnsolved();
  ASSERT_FALSE(unsolved.empty());
  EXPECT_EQ(unsolved.front(), "THING_1");
  EXPECT_TRUE(scene.world().TakeUnsolved().empty());
}

TEST(LimbsTest, WhatIsSolvedExactlyIsNotCounted) {
  PhysicsScene scene;
  AddRow(scene, 3);
  scene.RunFor(1);
  EXPECT_TRUE(scene.world().TakeUnsolved().empty());
}

}  // namespace
}  // namespace coopdyn::limbs
