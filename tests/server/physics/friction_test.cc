// SPDX-License-Identifier: MIT
// Friction of every kind against closed forms, at 1, 5 and 10 ms: isotropic at the onset of sliding, rolling,
// spinning, anisotropic. Each by the solver of piles and by that of limbs, which handles robots with
// thrusters.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::friction {
namespace {

constexpr double kRadius_m = 0.1, kArm_m = 0.002;  // of a ball, and of its rolling friction
constexpr double kDiagonal_rad = std::numbers::pi / 4;

JointModel Thruster(const char* name, const Vector3& axis) {
  JointModel joint;
  joint.name = name;
  joint.kind = JointModel::Kind::kForce;
  joint.axis_R = axis;
  joint.max_effort = 100;
  return joint;
}

/// One link, its centre in the origin of R. `thrusts`: by two thrusters along x and y.
RobotModel Body(const LinkShape& collision, double mass_kg, bool thrusts) {
  RobotModel model;
  model.type = "body";
  LinkModel link;
  link.name = "body";
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = SolidInertia(collision.shape, mass_kg);
  link.collisions = {collision};
  model.links = {link};
  model.footprint_radius_m = BoundingRadius(collision.shape);
  model.height_m = 1;
  if (!thrusts) return model;
  model.joints = {Thruster("x", Vector3::UnitX()), Thruster("y", Vector3::UnitY())};
  model.actuators = {{"thrusters", {0, 1}, ThrustersModel()}};
  return model;
}

enum class Solver { kPile, kLimbs };

class FrictionTest : public testing::TestWithParam<std::tuple<int, Solver>> {
 protected:
  void SetUp() override { scene_.step_length = std::get<int>(GetParam()) * 1'000'000; }
  /// A robot of one body with this speed.
  void Add(const LinkShape& collision, double mass_kg, const Pose& X_WR, const Vector3& v_W = Vector3::Zero(),
           const Vector3& w_W = Vector3::Zero()) {
    const bool thrusts = std::get<Solver>(GetParam()) == Solver::kLimbs;
    scene_.robot_model = std::make_shared<const RobotModel>(Body(collision, mass_kg, thrusts));
    scene_.AddRobot(X_WR);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints.assign(scene_.robot_model->joints.size(), {0, ControlMode::kIdle});
    Frame frame;
    scene_.world().Fill(frame);
    frame.bodies.back().v_WB = v_W;
    frame.bodies.back().w_WB = w_W;
    scene_.world().Restore(frame);
  }
  BodyState Now() { return scene_.Capture()->bodies.back(); }

  PhysicsScene scene_;
};

LinkShape Ball(double rolling_m, double spinning_m) {
  LinkShape ball{Sphere{kRadius_m}, {}, {}, 1, false};
  ball.rolling_friction_m = rolling_m;
  ball.spinning_friction_m = spinning_m;
  return ball;
}

LinkShape Sledge(double friction) {
  return {Box{{0.3, 0.3, 0.1}}, {}, {}, friction, false};
}

/// On a slope that falls towards 45°, where a pyramid along the axes would allow √2 of the friction.
class SlopeTest : public FrictionTest {
 protected:
  static constexpr double kFriction = 0.5;
  void AddOnSlope(double slope_rad) {
    const Quaternion q = FromRollPitchYaw(0, slope_rad, kDiagonal_rad);
    scene_.Add(Box{Vector3(30, 4, 0.2)}, {{0, 0, 12}, q});
    Add(Sledge(kFriction), 2, {Vector3(0, 0, 12) + q * Vector3(-7, 0, 0.15), q});
  }
};

TEST_P(SlopeTest, WhatIsSteeperThanFrictionSlidesInEveryDirection) {
  constexpr double kSlope_rad = 0.57;  // its tangent is 0.64: above 0.5, below 0.5 √2
  AddOnSlope(kSlope_rad);
  const Vector3 start = Now().p_WB;
  scene_.RunFor(3);
  const double acceleration = kG * (std::sin(kSlope_rad) - kFriction * std::cos(kSlope_rad));
  EXPECT_NEAR((Now().p_WB - start).norm() / (acceleration * 9 / 2), 1, 0.02);
}

TEST_P(SlopeTest, WhatIsLessSteepStands) {
  AddOnSlope(0.45);  // its tangent is 0.483
  const Vector3 start = Now().p_WB;
  scene_.RunFor(10);
  EXPECT_LT((Now().p_WB - start).norm(), 5e-4);  // until it sleeps, contacts appear and vanish
}

TEST_P(FrictionTest, ABallRollsToRestByItsFormula) {
  for (const double heading_rad : {0.0, 0.4, kDiagonal_rad}) {
    scene_ = PhysicsScene();
    SetUp();
    const Vector3 way(std::cos(heading_rad), std::sin(heading_rad), 0);
    Add(Ball(kArm_m, 0), 1, At(0, 0, kRadius_m), way, Vector3::UnitZ().cross(way) / kRadius_m);
    const double slower_m_s2 = 5.0 / 7 * kArm_m * kG / kRadius_m;
    scene_.RunFor(2);
    EXPECT_NEAR(Now().v_WB.norm(), 1 - 2 * slower_m_s2, 0.005) << heading_rad;
    scene_.RunFor(7);
    const double stop_m = 1 / (2 * slower_m_s2);
    EXPECT_NEAR(Now().p_WB.head<2>().norm() / stop_m, 1, 0.02) << heading_rad;
    EXPECT_EQ(Now().v_WB.norm(), 0) << heading_rad;
  }
}

TEST_P(FrictionTest, ARollerStopsByItsFormula) {
  LinkShape roller{Cylinder{kRadius_m, 0.3}, {}, {}, 1, false};
  roller.rolling_friction_m = kArm_m;
  const Quaternion q = FromRollPitchYaw(std::numbers::pi / 2, 0, 0.4);
  const Vector3 way(std::cos(0.4), std::sin(0.4), 0);
  Add(roller, 1, {{0, 0, kRadius_m}, q}, way, Vector3::UnitZ().cross(way) / kRadius_m);
  scene_.RunFor(2);
  const double slower_m_s2 = 2.0 / 3 * kArm_m * kG / kRadius_m;
  EXPECT_NEAR(Now().v_WB.norm(), 1 - 2 * slower_m_s2, 0.01);
}

TEST_P(FrictionTest, ASpinningBallStopsByItsFormula) {
  Add(Ball(0, kArm_m), 1, At(0, 0, kRadius_m), Vector3::Zero(), {0, 0, 20});
  const double slower_rad_s2 = kArm_m * kG / (0.4 * kRadius_m * kRadius_m);
  scene_.RunFor(2);
  EXPECT_NEAR(Now().w_WB.z(), 20 - 2 * slower_rad_s2, 0.01 * 20);
  scene_.RunFor(4);
  EXPECT_EQ(Now().w_WB.norm(), 0);
}

TEST_P(FrictionTest, RollingFrictionHoldsABallOnAGentleSlope) {
  constexpr double kSlope_rad = 0.015;  // below the ratio of friction's arm to the radius, 0.02
  const Quaternion q = FromRollPitchYaw(0, kSlope_rad, kDiagonal_rad);
  scene_.Add(Box{Vector3(30, 4, 0.2)}, {{0, 0, 3}, q});
  const Vector3 start = Vector3(0, 0, 3) + q * Vector3(0, 0, 0.1 + kRadius_m);
  Add(Ball(kArm_m, 0), 1, {start, q});
  scene_.RunFor(5);
  EXPECT_LT((Now().p_WB - start).norm(), 1e-4);
}

/// With 0.2 along x and 0.6 along y.
LinkShape Grained() {
  LinkShape sledge = Sledge(0.2);
  sledge.friction_along_G = Vector3::UnitX();
  sledge.friction_across = 0.6;
  return sledge;
}

TEST_P(FrictionTest, AGrainSlowsByTheCoefficientOfEachDirection) {
  for (const auto& [way, friction] : {std::pair(Vector3(1, 0, 0), 0.2), std::pair(Vector3(0, 1, 0), 0.6)}) {
    scene_ = PhysicsScene();
    SetUp();
    Add(Grained(), 1, At(0, 0, 0.05), 2 * way);
    scene_.RunFor(2);
    const double stop_m = 4 / (2 * friction * kG);
    EXPECT_NEAR(Now().p_WB.dot(way) / stop_m, 1, 0.03) << friction;
    EXPECT_LT(std::abs(Now().p_WB.dot(Vector3::UnitZ().cross(way))), 0.015 * stop_m);
  }
}

TEST_P(FrictionTest, AcrossItsGrainASlideBendsAsTheEllipseSays) {
  Add(Grained(), 1, At(0, 0, 0.05), {1.5, 1.5, 0});
  scene_.RunFor(0.3);
  Eigen::Vector2d v(1.5, 1.5), p(0, 0);
  constexpr int kParts = 30000;
  for (int i = 0; i < kParts; ++i) {
    const Eigen::Vector2d by_friction(0.2 * v.x(), 0.6 * v.y());
    const Eigen::Vector2d slower(0.04 * v.x(), 0.36 * v.y());
    v -= kG * 0.3 / kParts / by_friction.norm() * slower;
    p += 0.3 / kParts * v;
  }
  EXPECT_NEAR((Now().v_WB.head<2>() - v).norm(), 0, 0.04);
  EXPECT_NEAR((Now().p_WB.head<2>() - p).norm(), 0, 0.01);
}

TEST_P(FrictionTest, AGrainTurnsWithItsBody) {
  Add(Grained(), 1, {{0, 0, 0.05}, FromRollPitchYaw(0, 0, std::numbers::pi / 2)}, {0, 2, 0});
  scene_.RunFor(2);
  EXPECT_NEAR(Now().p_WB.y() / (4 / (2 * 0.2 * kG)), 1, 0.03);
}

TEST_P(FrictionTest, AGrainAskewToASlopeLetsItsBodySlideStraightAsTheEllipseSays) {
  LinkShape sledge = Sledge(0.1);
  sledge.friction_along_G = Vector3::UnitX();
  sledge.friction_across = 0.6;
  constexpr double kYaw_rad = 5 * std::numbers::pi / 180, kPull_m_s2 = 7, kDuration_s = 1;
  scene_.SetGravity(Vector3(0, kPull_m_s2, -kG));
  const Quaternion q = FromRollPitchYaw(0, 0, kYaw_rad);
  Add(sledge, 1, {{0, 0, 0.05}, q});
  scene_.RunFor(kDuration_s);
  // From rest the slip keeps its direction, so friction does, too. It acts through the point below the centre
  // of mass towards which it shifts the load: nothing turns the body.
  const Eigen::Vector2d pull(kPull_m_s2 * std::sin(kYaw_rad), kPull_m_s2 * std::cos(kYaw_rad));
  Eigen::Vector2d v(0, 0);  // along and across the grain
  constexpr int kParts = 100'000;
  constexpr double kPart_s = kDuration_s / kParts;
  for (int i = 0; i < kParts; ++i) {
    v += kPart_s * pull;
    const Eigen::Vector2d by_friction(0.1 * v.x(), 0.6 * v.y());
    v -= kPart_s * kG / by_friction.norm() * Eigen::Vector2d(0.01 * v.x(), 0.36 * v.y());
  }
  const Vector3 now = q.conjugate() * Now().v_WB;
  EXPECT_NEAR(now.x() / v.x(), 1, 0.05) << now.transpose() << " instead of " << v.transpose();
  EXPECT_NEAR(now.y() / v.y(), 1, 0.05);
  EXPECT_LT(Now().orientation().angularDistance(q), 0.02);
}

const auto kAll = testing::Combine(testing::Values(1, 5, 10), testing::Values(Solver::kPile, Solver::kLimbs));
INSTANTIATE_TEST_SUITE_P(Steps, FrictionTest, kAll);
INSTANTIATE_TEST_SUITE_P(Steps, SlopeTest, kAll);

class PushTest : public testing::TestWithParam<int> {
 protected:
  /// Distance that a box of 2 kg, friction 0.5, moves in 2 s by a force at 45°.
  double Pushed_m(double force_n) {
    PhysicsScene scene;
    scene.step_length = GetParam() * 1'000'000;
    scene.robot_model = std::make_shared<const RobotModel>(Body(Sledge(0.5), 2, true));
    scene.AddRobot(At(0, 0, 0.05));
    scene.RunFor(0.1);
    scene.setpoints.assign(2, {force_n * std::sqrt(0.5), ControlMode::kEffort});
    const Vector3 start = scene.robot(0).p;
    scene.RunFor(2);
    return (scene.robot(0).p - start).norm();
  }
};

TEST_P(PushTest, AForceAboveFrictionMovesABoxInEveryDirection) {
  EXPECT_NEAR(Pushed_m(12) / ((12 / 2.0 - 0.5 * kG) * 4 / 2), 1, 0.02);
}

TEST_P(PushTest, AForceBelowFrictionMovesNothing) {
  EXPECT_LT(Pushed_m(9.5), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Steps, PushTest, testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn::friction
