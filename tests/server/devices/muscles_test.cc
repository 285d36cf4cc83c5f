// SPDX-License-Identifier: MIT
// What the module of muscles tells, and the activations that it takes.
#include <gtest/gtest.h>

#include <memory>

#include "server/devices/devices.h"
#include "server/state/frame.h"

namespace coopdyn {
namespace {

class MusclesDeviceTest : public ::testing::Test {
 protected:
  MusclesDeviceTest() {
    auto model = std::make_shared<RobotModel>();
    LinkModel link;
    link.mass_kg = 1;
    link.inertia_kg_m2 = Vector3::Ones();
    model->links = {link, link};
    JointModel joint;
    joint.name = "biceps";
    joint.kind = JointModel::Kind::kMuscle;
    joint.child = 1;
    joint.muscle.emplace();
    joint.muscle->max_force_n = 30;
    joint.muscle->optimal_length_m = 0.5;
    joint.muscle->max_velocity_m_s = 3;
    model->joints = {joint, joint};
    model->joints[1].name = "triceps";
    model->actuators = {{"muscles", {0, 1}, MusclesModel()}};
    auto scenario = std::make_shared<Scenario>();
    scenario->robots.resize(1);
    scenario->robots[0].name = "rig";
    scenario->robots[0].model = model;
    frame_.scene = MakeScene(scenario);
    frame_.channels.resize(2);
    frame_.channels[1] = {0.5, -3, 7, {0.4, ControlMode::kPwm}};
    device_ = MakeDevice(*model, "muscles");
    model_ = model;
  }
  Message Request(command::Id id, std::vector<std::int32_t> muscles, std::vector<double> data = {}) {
    Message request;
    request.command = id;
    request.params = std::move(muscles);
    request.data = std::move(data);
    return request;
  }

  std::shared_ptr<const RobotModel> model_;
  Frame frame_;
  std::unique_ptr<Device> device_;
};

TEST_F(MusclesDeviceTest, TheyTellActivationForceLengthVelocityAndFactors) {
  EXPECT_EQ(device_->Read(Request(command::kGetMuscles, {2}), frame_, 0).data,
            (std::vector<double>{0.4, 7, 0.5, -3, 1, 0}));
  EXPECT_EQ(device_->Read(Request(command::kGetMuscles, {}), frame_, 0).data.size(), 12u);
}

TEST_F(MusclesDeviceTest, TheyTellWhatTheyAreAbleTo) {
  const Message reply = device_->Read(Request(command::kGetMuscleLimits, {}), frame_, 0);
  EXPECT_EQ(reply.data, (std::vector<double>{30, 0.5, 3, 30, 0.5, 3}));
  EXPECT_EQ(reply.text, "biceps triceps");
}

TEST_F(MusclesDeviceTest, AnActivationIsCutToItsRangeAndLeavesTheOthers) {
  const auto actuation = device_->Actuate(Request(command::kSetActivations, {2}, {-0.5}), frame_, 0);
  ASSERT_TRUE(actuation);
  EXPECT_EQ(actuation->setpoints.at(0).mode, ControlMode::kKeep);
  EXPECT_EQ(actuation->setpoints.at(1), (Setpoint{0, ControlMode::kPwm}));
  EXPECT_EQ(actuation->limited, "limited to 0");
}

TEST_F(MusclesDeviceTest, EachMuscleHasOneActivation) {
  EXPECT_TRUE(device_->Refuse(Request(command::kSetActivations, {}, {1})));
  EXPECT_TRUE(device_->Refuse(Request(command::kSetActivations, {3}, {1})));
  EXPECT_FALSE(device_->Refuse(Request(command::kSetActivations, {1}, {1})));
}

}  // namespace
}  // namespace coopdyn
