// SPDX-License-Identifier: MIT
// Motors with a set effort limit, and the energy of motors: a sledge on a horizontal rail.
#include <gtest/gtest.h>

#include <memory>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::limiters {
namespace {

constexpr double kMass_kg = 2, kMost_n = 40;

/// Channel 0 is the rail's motor, 1 its limiter.
RobotModel Sledge() {
  RobotModel model;
  model.type = "sledge";
  model.fixed_base = true;
  LinkModel base;
  base.name = "base";
  base.X_RL.p = {0, 0, 3};
  base.mass_kg = kMass_kg;
  base.inertia_kg_m2 = Vector3::Constant(0.01);
  base.collisions = {{Sphere{0.02}, {}, {}, 1, false}};
  LinkModel sledge = base;
  sledge.name = "sledge";
  sledge.X_RL.p = {0.5, 0, 3};
  model.links = {base, sledge};
  JointModel rail;
  rail.name = "rail";
  rail.kind = JointModel::Kind::kSlider;
  rail.child = 1;
  rail.p_RJ = sledge.X_RL.p;
  rail.axis_R = Vector3::UnitX();
  rail.max_effort = kMost_n;
  rail.max_velocity = 100;
  JointModel limiter;
  limiter.name = "rail limit";
  limiter.kind = JointModel::Kind::kLimiter;
  limiter.limits = 0;
  limiter.lower = 0;
  limiter.upper = limiter.max_effort = kMost_n;
  model.joints = {rail, limiter};
  model.actuators = {{"joints", {0}, BoardModel()}, {"motor limits", {1}, LimitersModel()}};
  model.footprint_radius_m = 1;
  model.height_m = 3.1;
  ChannelModel channel;
  ChannelModel::Value energy;
  energy.name = "energy";
  energy.quantity = ChannelModel::Quantity::kEnergy;
  energy.of = "rail";
  energy.sums_work = true;
  channel.values = {energy};
  model.AddSensor("channel", channel);
  return model;
}

class LimiterTest : public ::testing::Test {
 protected:
  LimiterTest() {
    scene_.step_length = 1'000'000;
    scene_.robot_model = std::make_shared<const RobotModel>(Sledge());
    scene_.AddRobot(0, 0);
    scene_.Build();
    EXPECT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints = {{50, ControlMode::kVelocity}, {}};
  }
  double speed() { return scene_.Capture()->channels[0].velocity; }

  PhysicsScene scene_;
};

TEST_F(LimiterTest, UntilItIsSetAMotorHasItsGreatestEffort) {
  scene_.RunFor(0.5);
  EXPECT_NEAR(speed(), kMost_n / kMass_kg * 0.5, 0.1);
}

TEST_F(LimiterTest, AMotorGivesNoMoreThanItsLimiterSays) {
  scene_.setpoints[1] = {3, ControlMode::kDirect};
  scene_.RunFor(1);
  EXPECT_NEAR(speed(), 3 / kMass_kg, 0.01 * 3 / kMass_kg);
}

TEST_F(LimiterTest, WithoutEffortAJointIsFree) {
  scene_.RunFor(0.2);
  const double before = speed();
  scene_.setpoints = {{0, ControlMode::kVelocity}, {0, ControlMode::kDirect}};
  scene_.RunFor(0.5);
  EXPECT_NEAR(speed(), before, 0.05);
}

TEST_F(LimiterTest, ALimiterTellsNothing) {
  scene_.setpoints[1] = {3, ControlMode::kDirect};
  scene_.RunFor(0.1);
  EXPECT_EQ(scene_.Capture()->channels[1].velocity, 0);
  EXPECT_EQ(scene_.Capture()->channels[1].effort, 0);
}

TEST_F(LimiterTest, TheEnergyOfAMotorIsItsWork) {
  scene_.setpoints[1] = {3, ControlMode::kDirect};
  scene_.RunFor(1);
  const double gained_j = kMass_kg * 1.5 * 1.5 / 2;
  EXPECT_NEAR(MeasuredBy(scene_)[0], gained_j, 0.01 * gained_j);
}

TEST_F(LimiterTest, BrakingCountsAsEnergyToo) {
  scene_.setpoints[1] = {3, ControlMode::kDirect};
  scene_.RunFor(1);
  scene_.setpoints[0].reference = 0;
  scene_.RunFor(1.1);
  const double gained_j = kMass_kg * 1.5 * 1.5 / 2;
  EXPECT_NEAR(MeasuredBy(scene_)[0], 2 * gained_j, 0.02 * gained_j);
}

}  // namespace
}  // namespace coopdyn::limiters
