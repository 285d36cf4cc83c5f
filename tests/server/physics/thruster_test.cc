// SPDX-License-Identifier: MIT
// Thrusters against Newton's and Euler's laws: a flying ball, and bodies attached to it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::thrusters {
namespace {

constexpr double kMass_kg = 2, kInertia_kg_m2 = 0.05, kHeight_m = 50, kGravity_m_s2 = 9.81;

JointModel Thruster(JointModel::Kind kind, const Vector3& axis, const Vector3& p_R) {
  JointModel joint;
  joint.name = "thruster";
  joint.kind = kind;
  joint.axis_R = axis;
  joint.p_RJ = p_R;
  joint.max_effort = 100;
  return joint;
}

/// A ball high above the floor, with these thrusters.
RobotModel Ball(const std::vector<JointModel>& thrusters) {
  RobotModel model;
  model.type = "ball";
  LinkModel ball;
  ball.name = "ball";
  ball.X_RL.p = {0, 0, kHeight_m};
  ball.mass_kg = kMass_kg;
  ball.inertia_kg_m2 = Vector3::Constant(kInertia_kg_m2);
  ball.collisions = {{Sphere{0.1}, {}, {}, 1, false}};
  model.links = {ball};
  model.joints = thrusters;
  ActuatorModel actuator{"thrusters", {}, ThrustersModel()};
  for (std::size_t i = 0; i < thrusters.size(); ++i) actuator.joints.push_back(static_cast<int>(i));
  model.actuators = {actuator};
  model.footprint_radius_m = 1;
  model.height_m = kHeight_m + 1;
  return model;
}

const Vector3 kCentre(0, 0, kHeight_m);

class ThrusterTest : public ::testing::Test {
 protected:
  void Add(const RobotModel& model) {
    scene_.step_length = 1'000'000;
    scene_.robot_model = std::make_shared<const RobotModel>(model);
    scene_.AddRobot(0, 0);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints.assign(model.joints.size(), {0, ControlMode::kIdle});
  }
  BodyState Body() { return scene_.Capture()->bodies.front(); }

  PhysicsScene scene_;
};

TEST_F(ThrusterTest, AFreeBodyAcceleratesByForceOverMass) {
  Add(Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitX(), kCentre)}));
  scene_.setpoints[0] = {3, ControlMode::kEffort};
  scene_.RunFor(2);
  const double wanted_m_s = 3 / kMass_kg * 2;
  EXPECT_NEAR(Body().v_WB.x(), wanted_m_s, 0.01 * wanted_m_s);
  EXPECT_NEAR(Body().p_WB.x(), wanted_m_s, 0.01 * wanted_m_s);  // a t² / 2 of 2 s
  EXPECT_NEAR(Body().w_WB.norm(), 0, 1e-9);
}

TEST_F(ThrusterTest, AForceThatIsItsWeightHoldsABodyInTheAir) {
  Add(Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitZ(), kCentre)}));
  scene_.setpoints[0] = {kMass_kg * kGravity_m_s2, ControlMode::kEffort};
  scene_.RunFor(2);
  EXPECT_NEAR(Body().p_WB.z(), kHeight_m, 1e-6);
}

TEST_F(ThrusterTest, ATorqueTurnsABodyByTorqueOverInertia) {
  Add(Ball({Thruster(JointModel::Kind::kTorque, Vector3::UnitY(), kCentre)}));
  scene_.setpoints[0] = {0.1, ControlMode::kEffort};
  scene_.RunFor(2);
  const double wanted_rad_s = 0.1 / kInertia_kg_m2 * 2;
  EXPECT_NEAR(Body().w_WB.y(), wanted_rad_s, 0.01 * wanted_rad_s);
  EXPECT_NEAR(Body().v_WB.x(), 0, 1e-9);
}

TEST_F(ThrusterTest, AForceBesideTheCentreTurnsTheBody) {
  Add(Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitX(), kCentre + Vector3(0, 0.1, 0))}));
  scene_.setpoints[0] = {0.5, ControlMode::kEffort};
  scene_.RunFor(0.2);
  const double wanted_rad_s = -0.1 * 0.5 / kInertia_kg_m2 * 0.2;
  EXPECT_NEAR(Body().w_WB.z(), wanted_rad_s, 0.01 * std::abs(wanted_rad_s));
}

TEST_F(ThrusterTest, ADirectionTurnsWithTheBody) {
  Add(Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitX(), kCentre),
            Thruster(JointModel::Kind::kTorque, Vector3::UnitZ(), kCentre)}));
  // A quarter turn: half of it accelerating, half decelerating.
  const double torque_nm = 0.1, half_s = std::sqrt(std::numbers::pi / 2 * kInertia_kg_m2 / torque_nm);
  scene_.setpoints[1] = {torque_nm, ControlMode::kEffort};
  scene_.RunFor(half_s);
  scene_.setpoints[1] = {-torque_nm, ControlMode::kEffort};
  scene_.RunFor(half_s);
  scene_.setpoints[1] = {0, ControlMode::kEffort};
  scene_.setpoints[0] = {4, ControlMode::kEffort};
  scene_.RunFor(1);
  EXPECT_NEAR(Body().v_WB.y(), 4 / kMass_kg, 0.02);
  EXPECT_NEAR(Body().v_WB.x(), 0, 0.05);
}

TEST_F(ThrusterTest, ItGivesNoMoreThanItsGreatestForce) {
  Add(Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitX(), kCentre)}));
  scene_.setpoints[0] = {1000, ControlMode::kEffort};
  scene_.RunFor(0.1);
  EXPECT_NEAR(Body().v_WB.x(), 100 / kMass_kg * 0.1, 0.01);
}

TEST_F(ThrusterTest, ItTellsItsForceAndTheSpeedAlongIt) {
  Add(Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitX(), kCentre)}));
  scene_.setpoints[0] = {3, ControlMode::kEffort};
  scene_.RunFor(1);
  const ChannelState told = scene_.Capture()->channels.front();
  EXPECT_NEAR(told.effort, 3, 1e-9);
  EXPECT_NEAR(told.velocity, 1.5, 0.02);
  EXPECT_NEAR(told.position, 0.75, 0.01);
}

TEST_F(ThrusterTest, AForcePushesWhatHangsOnItsLink) {
  RobotModel model = Ball({});
  model.links.push_back(model.links.front());
  model.links[1].name = "load";
  model.links[1].X_RL.p = {0, 0, kHeight_m - 0.5};
  JointModel ball;
  ball.name = "rope";
  ball.kind = JointModel::Kind::kBall;
  ball.child = 1;
  ball.p_RJ = kCentre;
  model.joints = {ball, Thruster(JointModel::Kind::kForce, Vector3::UnitZ(), kCentre)};
  model.actuators = {{"thrusters", {1}, ThrustersModel()}};
  Add(model);
  scene_.setpoints[0] = {2 * kMass_kg * kGravity_m_s2, ControlMode::kEffort};
  scene_.RunFor(1);
  EXPECT_NEAR(Body().p_WB.z(), kHeight_m, 1e-4);
}

TEST_F(ThrusterTest, AForceWakesABodyThatSleeps) {
  RobotModel model = Ball({Thruster(JointModel::Kind::kForce, Vector3::UnitX(), Vector3(0, 0, 0.1))});
  model.links[0].X_RL.p.z() = 0.1;
  model.height_m = 0.2;
  Add(model);
  scene_.RunFor(3);
  scene_.setpoints[0] = {2, ControlMode::kEffort};
  scene_.RunFor(1);
  EXPECT_GT(Body().v_WB.x(), 0.2);
}

}  // namespace
}  // namespace coopdyn::thrusters
