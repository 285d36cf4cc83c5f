// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "server/devices/device.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

class DeviceTest : public testing::Test {
 protected:
  std::unique_ptr<Device> Make(const std::string& type) { return MakeDevice(*SmallModel(), type); }
  static Message Request(command::Id id, std::vector<double> data = {}, std::vector<std::int32_t> params = {},
                         std::string text = {}) {
    return {0, std::move(text), id, std::move(params), std::move(data)};
  }

  SmallWorld world_{2};
};

TEST_F(DeviceTest, VelocityBecomesWheelSpeeds) {
  const auto actuation =
      Make("motors")->Actuate(Request(command::kSetVelocity, {0.2, 0.5}), *world_.frames.Latest(), 0);
  ASSERT_TRUE(actuation);
  EXPECT_NEAR(actuation->setpoints[0].reference, (0.2 - 0.5 * 0.2) / 0.1, 1e-12);
  EXPECT_NEAR(actuation->setpoints[1].reference, (0.2 + 0.5 * 0.2) / 0.1, 1e-12);
  EXPECT_EQ(actuation->limited, "");
  EXPECT_FALSE(actuation->steps);
}

TEST_F(DeviceTest, LimitScalesBothWheelsAndKeepsTheCurvature) {
  const auto motors = Make("motors");
  for (const double v : {-3.0, 0.0, 0.5, 2.0, 1e300, 1e308}) {
    for (const double w : {-20.0, 0.0, 7.0, 1e307}) {
      const auto actuation =
          motors->Actuate(Request(command::kSetVelocity, {v, w}), *world_.frames.Latest(), 0);
      const double left = actuation->setpoints[0].reference, right = actuation->setpoints[1].reference;
      EXPECT_LE(std::max(std::abs(left), std::abs(right)), 10.0);
      const double linear = (left + right) / 2 * 0.1;
      const double angular = (right - left) * 0.1 / 0.4;
      const double scale = std::max(std::abs(v), std::abs(w));
      if (scale == 0) continue;
      EXPECT_NEAR(linear * (w / scale), angular * (v / scale), 1e-12) << v << " " << w;
      EXPECT_EQ(actuation->limited.empty(), std::abs(v) <= 0.5 && w == 0) << v << " " << w;
    }
  }
}

TEST_F(DeviceTest, LimitIsToldInTheUnitsGiven) {
  const auto motors = Make("motors");
  EXPECT_EQ(motors->Actuate(Request(command::kSetVelocity, {2, 0}), *world_.frames.Latest(), 0)->limited,
            "limited to 1 m/s 0 rad/s");
  EXPECT_EQ(
      motors->Actuate(Request(command::kSetWheelSpeeds, {20, -10}), *world_.frames.Latest(), 0)->limited,
      "limited to 10 -5 rad/s");
  EXPECT_EQ(
      motors->Actuate(Request(command::kSetWheelSpeeds, {10, -10}), *world_.frames.Latest(), 0)->limited, "");
}

TEST_F(DeviceTest, StopMeansNoSpeedAndStepsAreTaken) {
  const auto actuation =
      Make("motors")->Actuate(Request(command::kStop, {}, {7}), *world_.frames.Latest(), 0);
  EXPECT_EQ(actuation->setpoints, std::vector<Setpoint>(2));
  EXPECT_EQ(actuation->steps, 7);
}

TEST_F(DeviceTest, GetCommandsActuateNothing) {
  EXPECT_FALSE(Make("motors")->Actuate(Request(command::kGetWheels), *world_.frames.Latest(), 0));
  EXPECT_FALSE(Make("pose")->Actuate(Request(command::kSetVelocity, {1, 1}), *world_.frames.Latest(), 0));
}

TEST_F(DeviceTest, LimitsAreTheModels) {
  EXPECT_EQ(Make("motors")->Read(Request(command::kGetLimits), *world_.frames.Latest(), 0).data,
            (std::vector<double>{10, 0.1, 0.4}));
}

TEST_F(DeviceTest, DistancesAreOnePerSensorAndInfinityWithoutAnything) {
  const Message reply = Make("distance")->Read(Request(command::kGetDistances), *world_.frames.Latest(), 0);
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(reply.data, (std::vector<double>{inf, inf, inf}));
}

TEST_F(DeviceTest, GeometryIsPerSensorRightToLeft) {
  const Message reply = Make("distance")->Read(Request(command::kGetGeometry), *world_.frames.Latest(), 0);
  EXPECT_EQ(reply.data, (std::vector<double>{-1, 0.2, 4, 0, 0.2, 4, 1, 0.2, 4}));
}

TEST_F(DeviceTest, TargetsHaveIdsDistancesBearingsAndColours) {
  const Message reply = Make("target")->Read(Request(command::kGetTargets), *world_.frames.Latest(), 0);
  EXPECT_EQ(reply.params, (std::vector<std::int32_t>{1, 2, 3}));
  EXPECT_EQ(reply.text, "red green red");
  ASSERT_EQ(reply.data.size(), 6u);
  EXPECT_NEAR(reply.data[0], 3, 1e-12);
  EXPECT_NEAR(reply.data[1], 0, 1e-12);
  EXPECT_NEAR(reply.data[2], 4, 1e-12);
  EXPECT_NEAR(reply.data[3], std::numbers::pi / 2, 1e-12);
}

TEST_F(DeviceTest, TargetByColourIsTheNearestInAnyCase) {
  const auto target = Make("target");
  const FramePtr frame = world_.frames.Latest();
  EXPECT_NEAR(target->Read(Request(command::kGetTarget, {}, {}, "Red"), *frame, 0).data[0], 3, 1e-12);
  EXPECT_NEAR(target->Read(Request(command::kGetTarget, {}, {3}), *frame, 0).data[0], 9, 1e-12);
}

TEST_F(DeviceTest, UnknownTargetNamesThoseThereAre) {
  const auto target = Make("target");
  const Message blue = target->Read(Request(command::kGetTarget, {}, {}, "blue"), *world_.frames.Latest(), 0);
  EXPECT_EQ(blue.error, 10);
  EXPECT_EQ(blue.text, "there is no blue target: there are red (1), green (2), red (3)");
  EXPECT_EQ(target->Read(Request(command::kGetTarget, {}, {4}), *world_.frames.Latest(), 0).error, 10);
}

TEST_F(DeviceTest, OtherRobotsAreSeenByName) {
  const Message reply = Make("target")->Read(Request(command::kGetRobots), *world_.frames.Latest(), 1);
  EXPECT_EQ(reply.text, "robot1");
  EXPECT_EQ(reply.params, (std::vector<std::int32_t>{1}));
  EXPECT_NEAR(reply.data[0], 10, 1e-12);
  EXPECT_NEAR(reply.data[1], -std::numbers::pi / 2, 1e-12);
}

TEST_F(DeviceTest, PoseIsThatOfTheAxleAndItsSpeedCarriedOver) {
  auto frame = world_.MakeFrame({});
  BodyState& body = frame->bodies[0];
  // Heading 90 degrees, turning on the spot about the axle: the centre of mass, 5 cm ahead, moves.
  const double s = std::sqrt(0.5);
  body.q_WB = {s, 0, 0, s};
  body.p_WB = Vector3(1, 2.05, 0.1);
  body.w_WB = Vector3(0, 0, 2);
  body.v_WB = Vector3(-0.1, 0.3, 0);
  const auto pose = Make("pose");
  const Message flat = pose->Read(Request(command::kGetPose), *frame, 0);
  ASSERT_EQ(flat.data.size(), 5u);
  EXPECT_NEAR(flat.data[0], 1, 1e-12);
  EXPECT_NEAR(flat.data[1], 2, 1e-12);
  EXPECT_NEAR(flat.data[2], std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(flat.data[3], 0.3, 1e-12);
  EXPECT_NEAR(flat.data[4], 2, 1e-12);
  const Message full = pose->Read(Request(command::kGetPose3d), *frame, 0);
  ASSERT_EQ(full.data.size(), 13u);
  EXPECT_NEAR(full.data[2], 0, 1e-12);
  EXPECT_NEAR(full.data[3], s, 1e-12);
  EXPECT_NEAR(full.data[7], 0, 1e-12);
  EXPECT_NEAR(full.data[8], 0.3, 1e-12);
  EXPECT_NEAR(full.data[12], 2, 1e-12);
}

TEST_F(DeviceTest, SensorsOfOneTypeAreReadByTheirModulesNames) {
  auto model = std::make_shared<RobotModel>(*SmallModel());
  SectorModel ahead = model->sectors()[1];
  ahead.max_range_m = 2;
  model->AddSensor("ahead", DistanceModel{{ahead}});
  model->AddSensor("north", CompassModel());
  auto scenario = std::make_shared<Scenario>(*SmallScenario(1));
  scenario->robots[0].model = model;
  scenario->robots[0].X_WR.q = FromRollPitchYaw(0, 0, 0.5);
  world_.Load(scenario, Mode::kLockstep);
  const FramePtr frame = world_.frames.Latest();
  const auto read = [&](const char* name, command::Id id) {
    return MakeDevice(*model, name)->Read(Request(id), *frame, 0).data;
  };
  EXPECT_EQ(read("distance", command::kGetDistances).size(), 3u);
  EXPECT_EQ(read("ahead", command::kGetDistances).size(), 1u);
  EXPECT_EQ(read("ahead", command::kGetGeometry), (std::vector<double>{0, 0.2, 2}));
  EXPECT_EQ(read("north", command::kGetCompass), std::vector<double>{Heading(RobotPose(*frame, 0).q)});
  EXPECT_EQ(MakeDevice(*model, "north")->table().module(), "compass");
}

// A load may replace the model of that name while a module has pending requests.
TEST_F(DeviceTest, AModelWithoutTheSensorReadsNothing) {
  auto model = std::make_shared<RobotModel>(*SmallModel());
  model->AddSensor("north", CompassModel());
  const auto compass = MakeDevice(*model, "north");
  EXPECT_TRUE(compass->Read(Request(command::kGetCompass), *world_.frames.Latest(), 0).data.empty());
}

TEST_F(DeviceTest, FirstReadingIsWhatReadGives) {
  for (const char* type : {"motors", "distance", "target", "pose"}) {
    const auto device = Make(type);
    std::vector<double> data;
    device->AppendFirstReading(*world_.frames.Latest(), 0, data);
    EXPECT_EQ(device->Read(Request(device->first_reading()), *world_.frames.Latest(), 0).data, data) << type;
    ASSERT_NE(device->table().Find(device->first_reading()), nullptr);
  }
}

TEST_F(DeviceTest, UnknownTypeHasNoDevice) {
  EXPECT_EQ(Make("laser"), nullptr);
}

}  // namespace
}  // namespace coopdyn
