// SPDX-License-Identifier: MIT
// Drive trains on a control board: their readings, and the duties that it accepts.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/server/devices/one_robot.h"

namespace coopdyn {
namespace {

class DriveTrainsTest : public ::testing::Test {
 protected:
  DriveTrainsTest() {
    auto model = std::make_shared<RobotModel>();
    LinkModel link;
    link.mass_kg = 1;
    link.inertia_kg_m2 = Vector3::Ones();
    model->links = {link, link, link};
    JointModel joint;
    joint.name = "geared";
    joint.child = 1;
    joint.max_effort = joint.max_velocity = 1;
    joint.drive_train.emplace();
    joint.drive_train->pwm = {{1, 10, 1, 2}};
    model->joints = {joint, joint};
    model->joints[1].name = "plain";
    model->joints[1].child = 2;
    model->joints[1].drive_train.reset();
    model->actuators = {{"joints", {1, 0}, BoardModel()}};
    frame_.scene = SceneOf(model);
    frame_.channels.resize(2);
    frame_.controls = StartControls(*frame_.scene);
    frame_.drive_trains = StartDriveTrains(*frame_.scene);
    device_ = MakeDevice(*model, "joints");
    model_ = model;
  }
  std::shared_ptr<const RobotModel> model_;
  Frame frame_;
  std::unique_ptr<Device> device_;
};

TEST_F(DriveTrainsTest, TheyTellRotorCurrentAndEnergy) {
  frame_.drive_trains.at(0) = {0.1, 0.2, 0.3, 0.4};
  const Message reply = device_->Read(Request(command::kGetDriveTrains, {2}), frame_, 0);
  EXPECT_EQ(reply.data, (std::vector{0.1, 0.2, 0.3, 0.4}));
}

TEST_F(DriveTrainsTest, AJointWithoutOneTellsNan) {
  const Message reply = device_->Read(Request(command::kGetDriveTrains, {}), frame_, 0);
  ASSERT_EQ(reply.data.size(), 8u);
  EXPECT_TRUE(std::isnan(reply.data[0]));
  EXPECT_EQ(reply.data[4], 0);
}

TEST_F(DriveTrainsTest, ADutyIsASetpointWithinItsRange) {
  const auto actuation = device_->Actuate(Request(command::kSetPwm, {2}, {-1.5}), frame_, 0);
  ASSERT_TRUE(actuation);
  EXPECT_EQ(actuation->setpoints.at(1), (Setpoint{-1, ControlMode::kPwm}));
  EXPECT_EQ(actuation->limited, "limited to -1");
}

TEST_F(DriveTrainsTest, AJointWithoutOneTakesNoDuty) {
  const auto refusal = device_->Refuse(Request(command::kSetPwm, {1}, {0.5}));
  ASSERT_TRUE(refusal);
  EXPECT_NE(refusal->text.find("joint plain has no drive train"), std::string::npos) << refusal->text;
  EXPECT_TRUE(device_->Refuse(Request(command::kSetModes, {1}, {5})));
  EXPECT_FALSE(device_->Refuse(Request(command::kSetModes, {2}, {5})));
}

}  // namespace
}  // namespace coopdyn
