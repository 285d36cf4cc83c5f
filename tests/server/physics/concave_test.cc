// SPDX-License-Identifier: MIT
// Concave meshes that move: they collide with their exact shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "server/geometry/convex_parts.h"
#include "server/physics/contacts.h"
#include "server/physics/things.h"
#include "tests/server/geometry/concave_solids.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

/// A body of these triangles that moves freely, with the mass and moments of a box about them.
std::shared_ptr<const RobotModel> Free(const Triangles& of, double mass_kg) {
  auto model = std::make_shared<RobotModel>();
  model->type = "solid";
  LinkModel link;
  link.name = "body";
  link.mass_kg = mass_kg;
  Vector3 middle;
  const MeshData whole = MakeMesh(of.vertices, of.triangles, middle);
  link.X_LI.p = middle;
  link.inertia_kg_m2 = SolidInertia(Box{2 * whole.half_m}, mass_kg);
  for (const auto& corners : ConvexParts(of.vertices, of.triangles)) {
    model->meshes.push_back(std::make_shared<const MeshData>(*ConvexHull(corners, middle)));
    LinkShape& piece = link.collisions.emplace_back();
    piece.shape = Mesh{model->meshes.back().get()};
    piece.X_LG.p = middle;
    if (link.collisions.size() > 1) piece.piece_of = 0;
  }
  model->links = {link};
  model->footprint_radius_m = whole.radius_m;
  model->height_m = 2 * whole.half_m.z();
  return model;
}

TEST(ConcaveTest, PiecesAreOneCollision) {
  const auto model = Free(Cup(), 0.2);
  const Mechanism mechanism = MakeRobot(*model, Fidelity::kFull, 1, Vector3(0, 0, -kG));
  ASSERT_GT(mechanism.parts.size(), 4u);
  for (const Part& part : mechanism.parts) EXPECT_EQ(part.collision, 0);
}

/// The floor contacts of a robot of `model` at `X_WR`.
std::vector<FoundContact> OnFloor(const Mechanism& mechanism, const Pose& X_WR) {
  Thing thing;
  thing.mechanism = &mechanism;
  const std::vector<BodyState> bodies = StartBodies(mechanism, X_WR);
  Collider collider;
  std::vector<FoundContact> found;
  FindFloorContacts(collider, {thing, bodies.data()}, 0, found);
  return found;
}

TEST(ConcaveTest, AllPiecesOfAMeshLieOnAsFewPointsAsOneSolid) {
  const auto model = Free(Ring(), 1);
  const Mechanism ring = MakeRobot(*model, Fidelity::kFull, 1, Vector3(0, 0, -kG));
  ASSERT_GT(ring.parts.size(), 8u);
  const std::vector<FoundContact> found = OnFloor(ring, {Vector3(0, 0, 0.199), Quaternion::Identity()});
  ASSERT_EQ(found.size(), 4u);
  Vector3 low = found[0].point.p_W, high = low;
  for (const FoundContact& one : found) {
    low = low.cwiseMin(one.point.p_W);
    high = high.cwiseMax(one.point.p_W);
  }
  // Its lowest circle has a radius of 1 m.
  EXPECT_GT((high - low).head<2>().minCoeff(), 1.4);
}

TEST(ConcaveTest, WhatPushesAnotherWayIsKept) {
  // Its legs stand in the tops of two boxes and its inner sides against them.
  const auto model = Free(Hook(), 1);
  const Mechanism hook = MakeRobot(*model, Fidelity::kFull, 1, Vector3(0, 0, -kG));
  WorldObject block;
  block.shape = Box{{0.082, 0.5, 0.5}};
  const Mechanism object = MakeObject(block);
  Thing of_hook, of_block;
  of_hook.mechanism = &hook;
  of_block.mechanism = &object;
  const std::vector<BodyState> bodies = StartBodies(hook, Pose());
  of_block.fixed.p_WB = {0, 0, 0.1 - 0.25 + 0.001};
  Collider collider;
  std::vector<FoundContact> found;
  FindContacts(collider, {of_hook, bodies.data()}, {of_block, &of_block.fixed}, 0, found);
  EXPECT_EQ(std::ranges::count_if(found, [](const auto& one) { return one.point.n_W.x() < -0.9; }), 4);
  EXPECT_EQ(std::ranges::count_if(found, [](const auto& one) { return one.point.n_W.x() > 0.9; }), 4);
  EXPECT_EQ(std::ranges::count_if(found, [](const auto& one) { return one.point.n_W.z() > 0.9; }), 4);
}

class StepLengths : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ConcaveTest, StepLengths, ::testing::Values(1, 5, 10));

TEST_P(StepLengths, ABallThatFallsIntoACupLiesOnItsBottom) {
  constexpr double kRadius_m = 0.02, kBottom_m = 0.005;
  PhysicsScene scene;
  scene.step_length = GetParam() * Nanoseconds{1'000'000};
  scene.robot_model = Free(Cup(), 0.2);
  scene.AddRobot(0, 0);
  scene.Add(Sphere{kRadius_m}, At(0.004, 0.002, 0.15), 0.03);
  scene.RunFor(5);
  const Pose X_WC = scene.robot(0), X_WB = scene.object(0);
  EXPECT_LT(TiltOf(X_WC), 1e-3);
  EXPECT_NEAR(X_WC.p.z(), 0, 5e-4);
  EXPECT_NEAR(X_WB.p.z(), kBottom_m + kRadius_m, 5e-4);
  EXPECT_LT((X_WB.p - X_WC.p).head<2>().norm(), 0.036 - kRadius_m);
}

TEST_P(StepLengths, AHookHangsOnABar) {
  constexpr double kBar_m = 0.01;
  PhysicsScene scene;
  scene.step_length = GetParam() * Nanoseconds{1'000'000};
  scene.robot_model = Free(Hook(), 0.2);
  // Its bar is 5 mm above the other one.
  scene.AddRobot(At(0, 0, 0.4));
  scene.Add(Cylinder{kBar_m, 0.3},
            {{0, 0, 0.4 + 0.1 - kBar_m - 0.005}, FromRollPitchYaw(std::numbers::pi / 2, 0, 0)});
  scene.RunFor(5);
  const Pose X_WH = scene.robot(0);
  EXPECT_NEAR(X_WH.p.z(), 0.395, 1e-3);
  EXPECT_LT(TiltOf(X_WH), 0.02);
}

/// 6 m by 6 m of hills of 5 cm.
std::shared_ptr<const RobotModel> Hills() {
  constexpr std::uint32_t kSide = 31;
  Triangles hills;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const double x = 0.2 * (i % kSide) - 3, y = 0.2 * (i / kSide) - 3;
    hills.vertices.emplace_back(x, y, 0.05 * std::sin(3 * x) * std::cos(3 * y) + 0.1);
  }
  for (std::uint32_t row = 0; row + 1 < kSide; ++row) {
    for (std::uint32_t i = row * kSide; i + 1 < (row + 1) * kSide; ++i)
      hills.AddFace(i, i + 1, i + kSide + 1, i + kSide);
  }
  auto model = std::make_shared<RobotModel>();
  model->type = "hills";
  model->fixed_base = true;
  Vector3 middle;
  model->meshes.push_back(
      std::make_shared<const MeshData>(MakeMesh(hills.vertices, hills.triangles, middle)));
  LinkModel link;
  link.name = "ground";
  link.mass_kg = 1;
  link.inertia_kg_m2 = Vector3::Ones();
  LinkShape& shape = link.collisions.emplace_back();
  shape.shape = Mesh{model->meshes.back().get()};
  shape.X_LG.p = middle;
  model->links = {link};
  model->footprint_radius_m = 4;
  model->height_m = 0.2;
  return model;
}

/// Two legs under a plate.
Triangles Bridge() {
  Triangles bridge;
  bridge.AddBox({-0.3, -0.1, 0}, {-0.2, 0.1, 0.2});
  bridge.AddBox({0.2, -0.1, 0}, {0.3, 0.1, 0.2});
  bridge.AddBox({-0.3, -0.1, 0.2}, {0.3, 0.1, 0.3});
  return bridge;
}

TEST_P(StepLengths, WhatIsDroppedOnHillsComesToRest) {
  PhysicsScene scene;
  scene.AllowOverlaps();
  scene.step_length = GetParam() * Nanoseconds{1'000'000};
  scene.robot_model = Hills();
  scene.AddRobot(0, 0);
  scene.robot_model = Free(Bridge(), 2);
  constexpr int kDrops = 9;
  for (int i = 0; i < kDrops; ++i)
    scene.AddRobot({{1.7 * (i % 3 - 1) + 0.1 * i, 1.7 * (i / 3 - 1) - 0.07 * i, 0.5},
                    Quaternion(Eigen::AngleAxisd(0.7 * i, Vector3::UnitZ()))});
  scene.RunFor(1);
  std::vector<Vector3> before;
  for (int i = 1; i <= kDrops; ++i) before.push_back(scene.robot(i).p);
  scene.RunFor(3);
  for (int i = 1; i <= kDrops; ++i)
    EXPECT_LT((scene.robot(i).p - before[static_cast<std::size_t>(i - 1)]).norm(), 0.05) << i;
}

}  // namespace
}  // namespace coopdyn
