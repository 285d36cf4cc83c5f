// SPDX-License-Identifier: MIT
// Modules of muscles and thrusters: their readings, and the activations, forces and torques that they accept.
#include <gtest/gtest.h>

#include <memory>

#include "tests/server/devices/one_robot.h"

namespace coopdyn {
namespace {

class ActuatorsDeviceTest : public ::testing::Test {
 protected:
  /// A robot with only `joints`, driven by the module `name`.
  void Make(const std::string& name, std::vector<JointModel> joints, decltype(ActuatorModel::kind) kind) {
    auto model = std::make_shared<RobotModel>();
    LinkModel link;
    link.mass_kg = 1;
    link.inertia_kg_m2 = Vector3::Ones();
    model->links = {link, link};
    model->joints = std::move(joints);
    model->actuators = {{name, {0, 1}, std::move(kind)}};
    frame_.scene = SceneOf(model);
    frame_.channels.resize(2);
    device_ = MakeDevice(*model, name);
    model_ = model;
  }

  void MakeMuscles() {
    JointModel biceps;
    biceps.name = "biceps";
    biceps.kind = JointModel::Kind::kMuscle;
    biceps.child = 1;
    biceps.muscle.emplace();
    biceps.muscle->max_force_n = 30;
    biceps.muscle->optimal_length_m = 0.5;
    biceps.muscle->max_velocity_m_s = 3;
    JointModel triceps = biceps;
    triceps.name = "triceps";
    Make("muscles", {biceps, triceps}, MusclesModel());
    frame_.channels[1] = {0.5, -3, 7, {0.4, ControlMode::kPwm}};
  }

  void MakeThrusters() {
    JointModel jet;
    jet.name = "jet";
    jet.kind = JointModel::Kind::kForce;
    jet.child = 1;
    jet.max_effort = 20;
    JointModel turner = jet;
    turner.name = "turner";
    turner.kind = JointModel::Kind::kTorque;
    turner.max_effort = 3;
    Make("thrusters", {jet, turner}, ThrustersModel());
    frame_.channels[0] = {0, 1.5, 12, {12, ControlMode::kEffort}};
    frame_.channels[1] = {0, -0.5, 2, {2, ControlMode::kEffort}};
  }

  std::shared_ptr<const RobotModel> model_;
  Frame frame_;
  std::unique_ptr<Device> device_;
};

TEST_F(ActuatorsDeviceTest, MusclesTellActivationForceLengthVelocityAndFactors) {
  MakeMuscles();
  EXPECT_EQ(device_->Read(Request(command::kGetMuscles, {2}), frame_, 0).data,
            (std::vector<double>{0.4, 7, 0.5, -3, 1, 0}));
  EXPECT_EQ(device_->Read(Request(command::kGetMuscles, {}), frame_, 0).data.size(), 12u);
}

TEST_F(ActuatorsDeviceTest, MusclesTellWhatTheyAreAbleTo) {
  MakeMuscles();
  const Message reply = device_->Read(Request(command::kGetMuscleLimits, {}), frame_, 0);
  EXPECT_EQ(reply.data, (std::vector<double>{30, 0.5, 3, 30, 0.5, 3}));
  EXPECT_EQ(reply.text, "biceps triceps");
}

TEST_F(ActuatorsDeviceTest, AnActivationIsCutToItsRangeAndLeavesTheOthers) {
  MakeMuscles();
  const auto actuation = device_->Actuate(Request(command::kSetActivations, {2}, {-0.5}), frame_, 0);
  ASSERT_TRUE(actuation);
  EXPECT_EQ(actuation->setpoints.at(0).mode, ControlMode::kKeep);
  EXPECT_EQ(actuation->setpoints.at(1), (Setpoint{0, ControlMode::kPwm}));
  EXPECT_EQ(actuation->limited, "limited to 0");
}

TEST_F(ActuatorsDeviceTest, EachMuscleHasOneActivation) {
  MakeMuscles();
  EXPECT_TRUE(device_->Refuse(Request(command::kSetActivations, {}, {1})));
  EXPECT_TRUE(device_->Refuse(Request(command::kSetActivations, {3}, {1})));
  EXPECT_FALSE(device_->Refuse(Request(command::kSetActivations, {1}, {1})));
}

TEST_F(ActuatorsDeviceTest, ThrustersTellForceOrTorqueAndVelocity) {
  MakeThrusters();
  EXPECT_EQ(device_->Read(Request(command::kGetThrusts, {}), frame_, 0).data,
            (std::vector<double>{12, 1.5, 2, -0.5}));
  EXPECT_EQ(device_->Read(Request(command::kGetThrusts, {2}), frame_, 0).data,
            (std::vector<double>{2, -0.5}));
}

TEST_F(ActuatorsDeviceTest, ThrustersTellTheirLimits) {
  MakeThrusters();
  const Message reply = device_->Read(Request(command::kGetThrusterLimits, {}), frame_, 0);
  EXPECT_EQ(reply.data, (std::vector<double>{20, 3}));
  EXPECT_EQ(reply.text, "jet turner");
}

TEST_F(ActuatorsDeviceTest, AThrustIsCutToItsLimitAndLeavesTheOthers) {
  MakeThrusters();
  const auto actuation = device_->Actuate(Request(command::kSetThrusts, {2}, {-5}), frame_, 0);
  ASSERT_TRUE(actuation);
  EXPECT_EQ(actuation->setpoints.at(0).mode, ControlMode::kKeep);
  EXPECT_EQ(actuation->setpoints.at(1), (Setpoint{-3, ControlMode::kEffort}));
  EXPECT_EQ(actuation->limited, "limited to -3");
}

TEST_F(ActuatorsDeviceTest, EachThrusterTakesOneValueAndAReadingNone) {
  MakeThrusters();
  EXPECT_TRUE(device_->Refuse(Request(command::kSetThrusts, {}, {1})));
  EXPECT_TRUE(device_->Refuse(Request(command::kSetThrusts, {3}, {1})));
  EXPECT_TRUE(device_->Refuse(Request(command::kGetThrusts, {}, {1})));
  EXPECT_FALSE(device_->Refuse(Request(command::kSetThrusts, {1}, {1})));
}

}  // namespace
}  // namespace coopdyn
