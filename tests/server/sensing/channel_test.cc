// SPDX-License-Identifier: MIT
// A channel's values of a frame, and its motors' set-points for external values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn::channel_sensing {
namespace {

using Measured = ChannelModel::Quantity;
using testing::DoubleNear;
using testing::ElementsAre;

/// The sample robot with an arm on its chassis: a hinge about y at a height of 0.2 m, its link 0.1 m farther
/// along x.
std::shared_ptr<RobotModel> Arm() {
  auto model = SampleRobot();
  LinkModel link;
  link.name = "arm";
  link.X_RL.p = {0.3, 0, 0.2};
  link.mass_kg = 0.2;
  model->links.push_back(link);
  JointModel joint;
  joint.name = "elbow";
  joint.child = static_cast<int>(model->links.size()) - 1;
  joint.p_RJ = {0.2, 0, 0.2};
  joint.stiffness = 3;
  joint.damping = 0.5;
  joint.max_effort = 2;
  joint.max_velocity = 4;
  model->joints.push_back(joint);
  return model;
}

ChannelModel::Value ValueOf(Measured quantity) {
  ChannelModel::Value value;
  value.name = "value";
  value.quantity = quantity;
  value.of = "elbow";
  return value;
}

/// The external values of these, with the arm turned by 0.3 rad at 0.7 rad/s.
std::vector<double> ValuesOf(std::vector<ChannelModel::Value> values, std::uint64_t step = 100) {
  const auto model = Arm();
  ChannelModel channel;
  channel.values = std::move(values);
  model->AddSensor("channel", channel);
  const auto frame = SampleWorld().Robot(At(1, 2, 0.5), model).MakeFrame();
  frame->step = step;
  const SceneRobot& robot = frame->scene->robots[0];
  const Pose X_WR = RobotPose(*frame, 0);
  BodyState& arm = frame->bodies[static_cast<std::size_t>(robot.first_body + model->joints[0].child)];
  const Vector3 p_WJ = X_WR * Vector3(0.2, 0, 0.2);
  const Quaternion q_WB = X_WR.q * FromRollPitchYaw(0, 0.3, 0);
  arm.q_WB = {q_WB.w(), q_WB.x(), q_WB.y(), q_WB.z()};
  arm.p_WB = p_WJ + q_WB * Vector3(0.1, 0, 0);
  arm.w_WB = X_WR.q * Vector3(0, 0.7, 0);
  arm.v_WB = arm.w_WB.cross(arm.p_WB - p_WJ);
  std::vector<double> data;
  AppendReading(*frame, 0, model->IndexOf<ChannelModel>(), data);
  return data;
}

TEST(ChannelTest, JointsWithoutMotorsHavePositionsAndVelocities) {
  EXPECT_THAT(ValuesOf({ValueOf(Measured::kPosition), ValueOf(Measured::kVelocity)}),
              ElementsAre(DoubleNear(0.3, 1e-9), DoubleNear(0.7, 1e-9)));
}

TEST(ChannelTest, ForcesOfJointsAreThoseOfTheirSprings) {
  EXPECT_THAT(ValuesOf({ValueOf(Measured::kEffort)}), ElementsAre(DoubleNear(-3 * 0.3 - 0.5 * 0.7, 1e-9)));
}

TEST(ChannelTest, PlacesAreThoseOfAnyLink) {
  std::vector<ChannelModel::Value> values;
  for (const Measured quantity :
       {Measured::kX, Measured::kY, Measured::kZ, Measured::kRoll, Measured::kPitch, Measured::kYaw,
        Measured::kVx, Measured::kVy, Measured::kVz, Measured::kWy}) {
    values.push_back(ValueOf(quantity));
    values.back().mount = {3, {}};
    values.back().in_body = quantity >= Measured::kVx;
  }
  const double x = 0.2 + 0.1 * std::cos(0.3);
  EXPECT_THAT(ValuesOf(values),
              ElementsAre(DoubleNear(1 + x * std::cos(0.5), 1e-9), DoubleNear(2 + x * std::sin(0.5), 1e-9),
                          DoubleNear(0.2 - 0.1 * std::sin(0.3), 1e-9), DoubleNear(0, 1e-9),
                          DoubleNear(0.3, 1e-9), DoubleNear(0.5, 1e-9), DoubleNear(0, 1e-9),
                          DoubleNear(0, 1e-9), DoubleNear(-0.07, 1e-9), DoubleNear(0.7, 1e-9)));
}

TEST(ChannelTest, AReadingIsTheNthOfItsModule) {
  ChannelModel::Value value = ValueOf(Measured::kReading);
  value.source = Arm()->IndexOf<DistanceModel>();
  value.index = 1;
  value.map = {0, 4, 1, 0};  // no reading in range is clamped to 4 m
  EXPECT_THAT(ValuesOf({value}), ElementsAre(0));
  value.index = 17;
  EXPECT_TRUE(std::isnan(ValuesOf({value})[0]));
}

TEST(ChannelTest, NoiseIsDrawnAnewInEachStepAndRepeats) {
  ChannelModel::Value value = ValueOf(Measured::kAmbientLight);
  value.noise = {MappedNoise::Kind::kUniform, 1, 0.25};
  EXPECT_EQ(ValuesOf({value}, 5), ValuesOf({value}, 5));
  EXPECT_NE(ValuesOf({value}, 5), ValuesOf({value}, 6));
  double sum = 0, least = 9, most = -9;
  constexpr int kSteps = 2000;
  for (int step = 0; step < kSteps; ++step) {
    const double one = ValuesOf({value}, static_cast<std::uint64_t>(step))[0];
    sum += one;
    least = std::min(least, one);
    most = std::max(most, one);
  }
  EXPECT_NEAR(sum / kSteps, 1, 0.02);
  EXPECT_GE(least, 0.75);
  EXPECT_LE(most, 1.25);
}

TEST(ChannelTest, MotorsAreMappedAndCut) {
  const auto model = Arm();
  BoardModel board;
  model->actuators.push_back({"joints", {0}, board});
  ChannelModel channel;
  ChannelModel::Motor motor;
  motor.mode = ControlMode::kVelocity;
  motor.map = {-8, 8, -1, 1};
  channel.motors = {motor};
  model->AddSensor("channel", channel);
  const auto frame = SampleWorld().Robot(At(0, 0), model).MakeFrame();
  const auto setpoints = [&](double external) { return ChannelSetpoints(*frame, 0, 0, {{external}})[0]; };
  EXPECT_EQ(setpoints(0.25), (Setpoint{2, ControlMode::kVelocity}));
  EXPECT_EQ(setpoints(1).reference, 4);  // its greatest velocity
  EXPECT_EQ(ChannelSetpoints(*frame, 0, 0, {})[0].mode, ControlMode::kKeep);
}

TEST(ChannelTest, AFrozenRobotAbortsTheTry) {
  const auto model = Arm();
  model->AddSensor("channel", ChannelModel());
  const auto frame = SampleWorld().Robot(At(0, 0), model).MakeFrame();
  EXPECT_FALSE(IsAborted(*frame, 0));
  frame->bodies[0].sleep_counter = BodyState::kFrozen;
  EXPECT_TRUE(IsAborted(*frame, 0));
}

TEST(ChannelTest, CurrentAndEnergyAreThoseOfTheDriveTrain) {
  const auto model = Arm();
  model->joints[0].drive_train.emplace();
  model->actuators.push_back({"joints", {0}, BoardModel()});
  ChannelModel channel;
  channel.values = {ValueOf(Measured::kCurrent), ValueOf(Measured::kEnergy)};
  model->AddSensor("channel", channel);
  const auto frame = SampleWorld().Robot(At(0, 0), model).MakeFrame();
  frame->controls = StartControls(*frame->scene);
  frame->drive_trains = StartDriveTrains(*frame->scene);
  ASSERT_EQ(frame->drive_trains.size(), 1u);
  frame->drive_trains[0] = {0, 0, 1.5, 20};
  std::vector<double> data;
  AppendReading(*frame, 0, model->IndexOf<ChannelModel>(), data);
  EXPECT_THAT(data, ElementsAre(1.5, 20));
}

TEST(ChannelTest, ValuesThatAreCalledAlikeAreNumbered) {
  ChannelModel channel;
  for (const char* name : {"eye", "place", "place"})
    channel.values.push_back(ValueOf(Measured::kX)), channel.values.back().name = name;
  EXPECT_THAT(FixedNames(channel), ElementsAre("eye", "place_1", "place_2"));
}

}  // namespace
}  // namespace coopdyn::channel_sensing
