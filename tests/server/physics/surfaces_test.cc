// SPDX-License-Identifier: MIT
// Shapes and surfaces of models against closed forms, at 1, 5 and 10 ms: bouncing, capsules, meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "server/geometry/mesh.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn::surfaces {
namespace {

constexpr double kGravity_m_s2 = 9.81;

/// One link with one shape, centred at the origin of R.
RobotModel Body(const std::string& type, const Shape& shape, double mass_kg) {
  RobotModel model;
  model.type = type;
  LinkModel link;
  link.name = "body";
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = SolidInertia(shape, mass_kg);
  LinkShape collision;
  collision.shape = shape;
  link.collisions = {collision};
  model.links = {link};
  model.footprint_radius_m = BoundingRadius(shape);
  model.height_m = 1;
  return model;
}

class SurfacesTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { scene_.step_length = GetParam() * 1'000'000; }
  void Add(RobotModel model, const Pose& X_WR) {
    scene_.robot_model = std::make_shared<const RobotModel>(std::move(model));
    scene_.AddRobot(X_WR);
  }
  double step_s() const { return GetParam() * 1e-3; }

  PhysicsScene scene_;
};

TEST_P(SurfacesTest, ABallBouncesByItsRestitution) {
  RobotModel ball = Body("ball", Sphere{0.1}, 0.5);
  ball.links[0].collisions[0].restitution = 0.8;
  Add(ball, At(0, 0, 1.1));
  scene_.Build();
  ASSERT_EQ(scene_.diagnostics().ToString(), "");
  double highest_m = 0, before_m = 1.1;
  bool rises = false;
  for (int i = 0; i * step_s() < 1.1; ++i) {
    scene_.Run(1);
    const double z_m = scene_.robot(0).p.z();
    rises |= z_m > before_m;
    before_m = z_m;
    if (rises) highest_m = std::max(highest_m, z_m - 0.1);
  }
  EXPECT_NEAR(highest_m, 0.8 * 0.8, 0.01);
}

TEST_P(SurfacesTest, WithoutRestitutionABallStaysDown) {
  Add(Body("ball", Sphere{0.1}, 0.5), At(0, 0, 0.6));
  scene_.RunFor(1);
  EXPECT_NEAR(scene_.robot(0).p.z(), 0.1, 2e-3);
}

TEST_P(SurfacesTest, WhatIsFixedMayReachBelowTheFloor) {
  RobotModel post = Body("post", Box{{0.2, 0.2, 2}}, 1);
  post.fixed_base = true;
  Add(post, At(0, 0, 0.5));
  scene_.Build();
  EXPECT_EQ(scene_.diagnostics().ToString(), "");
  scene_.RunFor(0.1);
  EXPECT_EQ(scene_.robot(0).p.z(), 0.5);
}

TEST_P(SurfacesTest, ACapsuleLiesOnItsSide) {
  Add(Body("capsule", Capsule{0.1, 0.4}, 1), {{0, 0, 0.1}, FromRollPitchYaw(0, std::acos(0.0), 0)});
  scene_.RunFor(2);
  EXPECT_NEAR(scene_.robot(0).p.z(), 0.1, 2e-3);
  EXPECT_NEAR(TiltOf(scene_.robot(0)), std::acos(0.0), 0.02);
}

TEST_P(SurfacesTest, ABoxSlidesDownAMeshRampByTheFormula) {
  constexpr double kSlope_rad = 0.5, kFriction = 0.2, kLength_m = 4;
  const double rise_m = kLength_m * std::tan(kSlope_rad);
  // A wedge that rises along x, 2 m wide.
  Vector3 middle;
  const MeshData wedge = MakeMesh(
      {{0, -1, 0},
       {0, 1, 0},
       {kLength_m, -1, 0},
       {kLength_m, 1, 0},
       {kLength_m, -1, rise_m},
       {kLength_m, 1, rise_m}},
      {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}, {0, 4, 5}, {0, 5, 1}, {0, 2, 4}, {1, 5, 3}}, middle);
  RobotModel ramp = Body("ramp", Mesh{&wedge}, 100);
  ramp.fixed_base = true;
  Add(ramp, {middle, Quaternion::Identity()});
  RobotModel box = Body("sledge", Box{{0.2, 0.2, 0.1}}, 1);
  box.links[0].collisions[0].friction = kFriction;
  const double x_m = 3, gap_m = 1e-4;
  const Vector3 normal(-std::sin(kSlope_rad), 0, std::cos(kSlope_rad));
  Add(box, {Vector3(x_m, 0, x_m * std::tan(kSlope_rad)) + (0.05 + gap_m) * normal,
            FromRollPitchYaw(0, -kSlope_rad, 0)});
  scene_.Build();
  ASSERT_EQ(scene_.diagnostics().ToString(), "");
  const Vector3 start = scene_.robot(1).p;
  scene_.RunFor(0.8);
  const double way_m = (scene_.robot(1).p - start).norm();
  const double acceleration = kGravity_m_s2 * (std::sin(kSlope_rad) - kFriction * std::cos(kSlope_rad));
  EXPECT_NEAR(way_m / (acceleration * 0.8 * 0.8 / 2), 1, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Steps, SurfacesTest, ::testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn::surfaces
