// SPDX-License-Identifier: MIT
// Joints without motors against closed forms, at 1, 5 and 10 ms.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "tests/server/physics/rig.h"

namespace coopdyn {
namespace {

constexpr double kGravity_m_s2 = 9.81;
constexpr double kPi = std::numbers::pi;

/// Hinged to the base, `angle_rad` from hanging.
RobotModel Pendulum(double length_m, double angle_rad, double inertia_kg_m2) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("bob", {-length_m * std::sin(angle_rad), 0, 3 - length_m * std::cos(angle_rad)},
                             1, inertia_kg_m2));
  model.joints = {Hinge("pivot", 0, 1, {0, 0, 3})};
  return model;
}

/// A carriage on a rail along x.
RobotModel Carriage() {
  RobotModel model = OnAPost();
  model.links.push_back(Link("carriage", {0, 0, 3}, 2, 0.01));
  JointModel rail = Hinge("rail", 0, 1, {0, 0, 3});
  rail.kind = JointModel::Kind::kSlider;
  rail.axis_R = Vector3::UnitX();
  model.joints = {rail};
  return model;
}

class JointsTest : public ::testing::TestWithParam<int> {
 protected:
  void Add(RobotModel model) { BuildWith(std::move(model), GetParam(), scene_); }
  double step_s() const { return GetParam() * 1e-3; }
  Pose Where(int link) { return LinkPose(*scene_.Capture(), 0, link); }
  const BodyState& body(std::size_t index) {
    frame_ = scene_.Capture();
    return frame_->bodies[index];
  }
  double Angle(int link) { return 2 * std::atan2(Where(link).q.y(), Where(link).q.w()); }

  /// Time of a pendulum from its start to the vertical.
  double TimeToHang_s() {
    int steps = 0;
    while (Where(1).p.x() < 0 && steps * step_s() < 10) {
      scene_.Run(1);
      ++steps;
    }
    return steps * step_s();
  }

  /// Rest angle of a damped pendulum that falls from the horizontal onto a stop 0.5 rad below.
  double AngleAtStop(double damping, double friction) {
    RobotModel model = Pendulum(0.5, kPi / 2, 0.02);
    model.joints[0].lower = -0.5;
    model.joints[0].damping = damping;
    model.joints[0].friction = friction;
    Add(model);
    scene_.RunFor(5);
    return Angle(1);
  }

  PhysicsScene scene_;
  std::shared_ptr<Frame> frame_;
};

TEST_P(JointsTest, APendulumSwingsWithItsPeriod) {
  const double length_m = 0.5, inertia_kg_m2 = 0.02;
  Add(Pendulum(length_m, 0.05, inertia_kg_m2));
  const double period_s =
      2 * kPi * std::sqrt((inertia_kg_m2 + length_m * length_m) / (kGravity_m_s2 * length_m));
  // Ten swings, counted at the vertical.
  int crossings = 0;
  double last_s = 0, before = Where(1).p.x();
  for (int step = 1; crossings < 20; ++step) {
    ASSERT_LT(step * step_s(), 12 * period_s);
    scene_.Run(1);
    const double x = Where(1).p.x();
    if (x * before < 0) {
      ++crossings;
      last_s = step_s() * (step - x / (x - before));
    }
    before = x;
  }
  EXPECT_NEAR(last_s / (9.75 * period_s), 1, 2e-3);
}

TEST_P(JointsTest, ABallTurnsAboutEachAxis) {
  for (const bool along_x : {false, true}) {
    scene_ = PhysicsScene();
    RobotModel model = Pendulum(0.5, 0.3, 0.02);
    if (along_x) model.links[1].X_RL.p = {0, model.links[1].X_RL.p.x(), model.links[1].X_RL.p.z()};
    model.joints[0].kind = JointModel::Kind::kBall;
    Add(model);
    scene_.RunFor(kPi * std::sqrt((0.02 + 0.25) / (kGravity_m_s2 * 0.5)));  // half a period, nearly
    const Vector3 p = Where(1).p;
    EXPECT_NEAR(along_x ? p.y() : p.x(), 0.5 * std::sin(0.3), 0.01);
    EXPECT_NEAR((p - Vector3(0, 0, 3)).norm(), 0.5, 1e-3);
  }
}

TEST_P(JointsTest, AUniversalJointKeepsItsChildFromTwisting) {
  RobotModel model = Pendulum(0.5, 0.3, 0.02);
  model.links[1].X_RL.p.y() = -0.1;
  model.joints[0].kind = JointModel::Kind::kUniversal;
  model.joints[0].axis_R = Vector3::UnitX();
  model.joints[0].axis2_R = Vector3::UnitY();
  Add(model);
  double most = 0;
  for (int i = 0; i < static_cast<int>(1 / step_s()); ++i) {
    scene_.Run(1);
    const Matrix3 R = Where(1).q.toRotationMatrix();
    // The first axis stays the base's, the second one the child's, at right angles to it.
    most = std::max(most, std::abs(Vector3::UnitX().dot(R * Vector3::UnitY())));
  }
  EXPECT_LT(most, 2e-3);
  EXPECT_GT(std::abs(Where(1).p.x() + 0.5 * std::sin(0.3)), 0.05);
}

TEST_P(JointsTest, ASpringAndADamperFollowTheFormula) {
  RobotModel model = Carriage();
  JointModel& rail = model.joints[0];
  rail.stiffness = 50;
  rail.damping = 4;
  rail.rest = 0.2;
  Add(model);
  const double decay = 4 / (2 * 2.0), omega = std::sqrt(50 / 2.0 - decay * decay);
  for (int i = 1; i <= static_cast<int>(2 / step_s()); ++i) {
    scene_.Run(1);
    const double t_s = i * step_s();
    const double way_m =
        std::exp(-decay * t_s) * (std::cos(omega * t_s) + decay / omega * std::sin(omega * t_s));
    ASSERT_NEAR(Where(1).p.x(), 0.2 * (1 - way_m), 5e-4 * GetParam()) << t_s;
  }
  scene_.RunFor(10);
  EXPECT_NEAR(Where(1).p.x(), 0.2, 5e-4) << "it sleeps once it has been slow for long enough";
}

TEST_P(JointsTest, AStiffSpringIsStable) {
  RobotModel model = Carriage();
  model.joints[0].stiffness = 1e7;
  model.joints[0].rest = 0.1;
  Add(model);
  scene_.RunFor(1);
  EXPECT_NEAR(Where(1).p.x(), 0.1, 1e-3);
}

TEST_P(JointsTest, AStopHoldsWhatHangsOnIt) {
  EXPECT_NEAR(AngleAtStop(0, 0), -0.5, 2e-3);
}

TEST_P(JointsTest, ADampedJointMeetsItsStop) {
  EXPECT_NEAR(AngleAtStop(0.05, 0), -0.5, 2e-3);
}

TEST_P(JointsTest, AJointWithFrictionMeetsItsStop) {
  EXPECT_NEAR(AngleAtStop(0, 0.5), -0.5, 2e-3);
}

TEST_P(JointsTest, ASpringPullsItsJointOffTheStop) {
  RobotModel model = Carriage();
  JointModel& rail = model.joints[0];
  rail.lower = 0;
  rail.stiffness = 20;
  rail.damping = 10;
  rail.rest = 0.1;
  Add(model);
  scene_.RunFor(8);
  EXPECT_NEAR(Where(1).p.x(), 0.1, 2e-3);
}

TEST_P(JointsTest, FrictionHoldsUpToItsEffort) {
  RobotModel model = Carriage();
  model.joints[0].axis_R = Vector3::UnitZ();
  model.joints[0].friction = 2 * kGravity_m_s2 + 0.1;
  Add(model);
  scene_.RunFor(1);
  EXPECT_NEAR(Where(1).p.z(), 3, 1e-4);
}

TEST_P(JointsTest, LessFrictionLetsItFallWithTheRest) {
  RobotModel model = Carriage();
  model.joints[0].axis_R = Vector3::UnitZ();
  model.joints[0].friction = kGravity_m_s2;  // half its weight
  Add(model);
  scene_.RunFor(0.5);
  EXPECT_NEAR(3 - Where(1).p.z(), kGravity_m_s2 / 2 * 0.25 / 2, kGravity_m_s2 / 2 * 0.5 * step_s());
}

TEST_P(JointsTest, AFixedBaseDoesNotMoveABit) {
  Add(Pendulum(0.5, 1, 0.02));
  const BodyState before = body(0);
  scene_.RunFor(2);
  EXPECT_EQ(body(0).p_WB, before.p_WB);
  EXPECT_EQ(body(0).q_WB, before.q_WB);
  EXPECT_EQ(body(0).v_WB, before.v_WB);
}

TEST_P(JointsTest, AFourBarLinkageStaysClosed) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("crank", {0, 0, 3.1}, 0.5, 0.002));
  model.links.push_back(Link("coupler", {0.2, 0, 3.25}, 0.5, 0.01));
  model.links.push_back(Link("rocker", {0.4, 0, 3.15}, 0.5, 0.005));
  model.joints = {Hinge("a", 0, 1, {0, 0, 3}), Hinge("b", 1, 2, {0, 0, 3.2}), Hinge("c", 2, 3, {0.4, 0, 3.3}),
                  Hinge("d", 0, 3, {0.4, 0, 3})};
  Add(model);
  double worst_m = 0;
  for (int i = 0; i < static_cast<int>(3 / step_s()); ++i) {
    scene_.Run(1);
    // The coupler's ends stay on their circles: the crank's of 0.2 m, the rocker's of 0.3 m.
    const Pose X_WC = Where(2);
    const Vector3 b = X_WC * Vector3(-0.2, 0, -0.05), c = X_WC * Vector3(0.2, 0, 0.05);
    worst_m = std::max({worst_m, std::abs((b - Vector3(0, 0, 3)).norm() - 0.2),
                        std::abs((c - Vector3(0.4, 0, 3)).norm() - 0.3)});
  }
  EXPECT_LT(worst_m, 1e-4 * GetParam());
}

TEST_P(JointsTest, AnArmatureAddsToTheInertiaThatSwings) {
  RobotModel model = Pendulum(0.5, 0.05, 0.02);
  model.joints[0].armature = 0.4;
  Add(model);
  const double quarter_s = kPi / 2 * std::sqrt((0.02 + 0.25 + 0.4) / (kGravity_m_s2 * 0.5));
  EXPECT_NEAR(TimeToHang_s(), quarter_s, 0.01 * quarter_s + step_s());
}

TEST_P(JointsTest, ASwingWithAnArmatureKeepsItsEnergy) {
  RobotModel model = Pendulum(0.5, kPi / 2, 0.02);
  model.joints[0].armature = 0.4;
  Add(model);
  scene_.RunFor(8);
  double highest_m = 0;
  for (int i = 0; i < static_cast<int>(4 / step_s()); ++i) {
    scene_.Run(1);
    highest_m = std::max(highest_m, Where(1).p.z());
  }
  EXPECT_NEAR(highest_m, 3, 1e-3);
}

TEST_P(JointsTest, AnArmatureSlowsWhatFallsOnARail) {
  RobotModel model = Carriage();
  model.joints[0].axis_R = Vector3::UnitZ();
  model.joints[0].armature = 3;
  Add(model);
  scene_.RunFor(0.7);
  EXPECT_NEAR(3 - Where(1).p.z(), kGravity_m_s2 * 2 / (2 + 3) * 0.7 * 0.7 / 2, 1e-4);
}

TEST_P(JointsTest, WhatSlidesMayHaveNoRoomAcross) {
  // A ball on two rails, along x and z: it cannot move along y.
  RobotModel model = OnAPost();
  model.links.push_back(Link("carriage", {0, 0, 0.02}, 1e-6, 1e-12));
  model.links.push_back(Link("ball", {0, 0, 0.02}, 2, 0.01));
  model.links[1].collisions.clear();
  for (int i = 0; i < 2; ++i) {
    JointModel rail = Hinge(i == 0 ? "along" : "up", i, i + 1, {0, 0, 0.02});
    rail.kind = JointModel::Kind::kSlider;
    rail.axis_R = i == 0 ? Vector3::UnitX() : Vector3::UnitZ();
    model.joints.push_back(rail);
  }
  scene_.SetFloorFriction(0.1).SetGravity(Vector3(3, 0, -kGravity_m_s2));
  Add(model);
  scene_.RunFor(1);
  EXPECT_TRUE(scene_.world().TakeFrozen().empty());
  EXPECT_NEAR(Where(2).p.x(), (3 - 0.1 * kGravity_m_s2) / 2, 0.02);
}

/// Joint 0 swings on the post; joint 1 turns a disc about the post's x axis with it.
RobotModel Geared(double multiplier) {
  RobotModel model = Pendulum(0.5, 0.05, 0.02);
  model.links.push_back(Link("disc", {0, 0, 3}, 1, 0.03));
  model.joints.push_back(Hinge("gear", 0, 2, {0, 0, 3}));
  model.joints[1].axis_R = Vector3::UnitX();
  model.couplings = {{1, 0, multiplier, 0}};
  return model;
}

TEST_P(JointsTest, AGearboxAddsTheInertiaBeyondItByItsRatioSquared) {
  Add(Geared(-3));
  const double inertia_kg_m2 = 0.02 + 0.25 + 9 * 0.03;
  const double quarter_s = kPi / 2 * std::sqrt(inertia_kg_m2 / (kGravity_m_s2 * 0.5));
  EXPECT_NEAR(TimeToHang_s(), quarter_s, 0.01 * quarter_s + step_s());
}

TEST_P(JointsTest, AFollowerKeepsToItsLeader) {
  Add(Geared(2));
  double worst_rad = 0;
  for (int i = 0; i < static_cast<int>(5 / step_s()); ++i) {
    scene_.Run(1);
    const Quaternion disc = Where(2).q;
    worst_rad = std::max(worst_rad, std::abs(2 * std::atan2(disc.x(), disc.w()) - 2 * Angle(1)));
  }
  EXPECT_LT(worst_rad, 1e-5);
  EXPECT_GT(worst_rad, 0) << "it has moved";
}

TEST_P(JointsTest, AWinchLetsItsLoadFallByTheFormula) {
  // The drum turns many times: its angle is not wrapped at ±π.
  RobotModel model = Carriage();
  model.joints[0].axis_R = Vector3::UnitZ();
  model.links.push_back(Link("drum", {0, 0, 3}, 1, 0.01));
  model.joints.push_back(Hinge("axle", 0, 2, {0, 0, 3}));
  const double radius_m = 0.05;
  model.couplings = {{1, 0, 1 / radius_m, 0}};
  Add(model);
  scene_.RunFor(0.7);
  const double acceleration = kGravity_m_s2 * 2 / (2 + 0.01 / (radius_m * radius_m));
  EXPECT_NEAR(3 - Where(1).p.z(), acceleration * 0.7 * 0.7 / 2, 1e-4);
}

TEST_P(JointsTest, ANutFallsAlongItsScrewByTheFormula) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("nut", {0, 0, 3}, 2, 0.01));
  JointModel screw = Hinge("screw", 0, 1, {0, 0, 3});
  screw.kind = JointModel::Kind::kScrew;
  screw.axis_R = Vector3::UnitZ();
  screw.pitch_m_rad = 0.05;
  model.joints = {screw};
  Add(model);
  const double acceleration = kGravity_m_s2 * 2 * 0.05 * 0.05 / (2 * 0.05 * 0.05 + 0.01);
  for (int i = 1; i <= static_cast<int>(0.8 / step_s()); ++i) {
    scene_.Run(1);
    const double fallen_m = acceleration * i * i * step_s() * step_s() / 2;
    ASSERT_NEAR(3 - Where(1).p.z(), fallen_m, 1e-6);
    const Quaternion q = Where(1).q, turned(Eigen::AngleAxisd(-fallen_m / 0.05, Vector3::UnitZ()));
    ASSERT_LT(q.angularDistance(turned), 1e-4);
  }
}

TEST_P(JointsTest, ASliderCrankMovesItsPistonByTheFormula) {
  const double crank_m = 0.1, rod_m = 0.3;
  RobotModel model = OnAPost();
  model.links.push_back(Link("crank", {0.05, 0, 3.05}, 0.5, 0.002));
  model.links.push_back(Link("rod", {0.15, 0, 3}, 0.5, 0.005));
  model.links.push_back(Link("piston", {0.4, 0, 3}, 0.5, 0.002));
  // The crank points along x at first.
  model.joints = {Hinge("main", 0, 1, {0, 0, 3}), Hinge("crankpin", 1, 2, {crank_m, 0, 3}),
                  Hinge("gudgeon", 2, 3, {crank_m + rod_m, 0, 3}), Hinge("bore", 0, 3, {0.4, 0, 3})};
  model.joints[3].kind = JointModel::Kind::kSlider;
  model.joints[3].axis_R = Vector3::UnitX();
  Add(model);
  double worst_m = 0, least_m = 1;
  for (int i = 0; i < static_cast<int>(3 / step_s()); ++i) {
    scene_.Run(1);
    const double angle = Angle(1), across_m = crank_m * std::sin(angle);
    const double way_m = crank_m * std::cos(angle) + std::sqrt(rod_m * rod_m - across_m * across_m);
    worst_m = std::max(worst_m, std::abs(Where(3).p.x() - way_m));
    least_m = std::min(least_m, way_m);
  }
  EXPECT_LT(worst_m, 1e-4 * GetParam());
  EXPECT_LT(least_m, 0.35) << "it has moved";
}

INSTANTIATE_TEST_SUITE_P(Steps, JointsTest, ::testing::Values(1, 5, 10),
                         [](const auto& info) { return std::to_string(info.param) + "ms"; });

}  // namespace
}  // namespace coopdyn
