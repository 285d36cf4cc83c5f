// SPDX-License-Identifier: MIT
#include "server/yarp/port_name.h"

#include <gtest/gtest.h>

#include <string>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"

namespace coopdyn {
namespace {

TEST(YarpPortName, HasTheModuleTheReadingAndTheSteps) {
  const auto state = ParseYarpPortName("/robot1/pose/state:o");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->module, "/robot1/pose");
  EXPECT_EQ(state->subject, "state");
  EXPECT_EQ(state->every, 1);
  const auto slow = ParseYarpPortName("/robot1/pose/25/pose_3d:o");
  ASSERT_TRUE(slow);
  EXPECT_EQ(slow->module, "/robot1/pose");
  EXPECT_EQ(slow->subject, "pose_3d");
  EXPECT_EQ(slow->every, 25);
  const auto command = ParseYarpPortName("/robot1/motors/command:i");
  ASSERT_TRUE(command);
  EXPECT_TRUE(command->takes);
}

TEST(YarpPortName, ARobotMayBeCalledByANumber) {
  EXPECT_EQ(ParseYarpPortName("/7/pose/state:o")->module, "/7/pose");
  EXPECT_EQ(ParseYarpPortName("/7/state:o")->module, "/7");
}

TEST(YarpPortName, OtherNamesAreNone) {
  for (const char* name : {"", "/", ":o", "/:o", "/state:o", "/robot1/pose", "/robot1/pose/:o",
                           "/robot1/motors/velocity:i", "/robot1/motors/10/commands:i"}) {
    EXPECT_FALSE(ParseYarpPortName(name)) << name;
  }
}

TEST(YarpPortName, StepsThatCannotBeBelongToTheModule) {
  for (const char* steps : {"0", "-1", "99999999999", "1x"}) {
    const std::string module = std::string("/robot1/pose/") + steps;
    EXPECT_EQ(ParseYarpPortName(module + "/state:o")->module, module);
  }
}

TEST(StreamOf, IsTheFirstReadingUnlessTheNameHasAnother) {
  const CommandTable pose = PoseTable();
  for (const char* name : {"/robot1/pose", "/robot1/pose/state:o", "/robot1/pose/command:i"})
    EXPECT_EQ(StreamOf(name, pose)->reading, command::kGetPose) << name;
  EXPECT_EQ(StreamOf("/robot1/pose/5/pose_3d:o", pose)->reading, command::kGetPose3d);
  EXPECT_EQ(StreamOf("/robot1/pose/5/pose_3d:o", pose)->every, 5);
}

TEST(StreamOf, IsNothingWithoutThatReading) {
  EXPECT_FALSE(StreamOf("/robot1/pose/speed:o", PoseTable()));
  EXPECT_FALSE(StreamOf("/robot1/motors/velocity:o", MotorsTable()));
}

TEST(StreamOf, JointsHaveThePortsOfControlBoards) {
  EXPECT_EQ(StreamOf("/robot1/arm/state:o", JointsTable())->sample, YarpSample::kBoardPositions);
  EXPECT_EQ(StreamOf("/robot1/arm/5/stateExt:o", JointsTable())->sample, YarpSample::kBoard);
  EXPECT_EQ(StreamOf("/robot1/arm/5/stateExt:o", JointsTable())->every, 5);
  EXPECT_EQ(StreamOf("/robot1/arm/joints:o", JointsTable())->reading, command::kGetJoints);
}

TEST(TalkOf, ControlBoardsAreSpokenToInTheWordsOfBothVersions) {
  EXPECT_EQ(TalkOf("/robot1/arm/rpc:i", JointsTable()), YarpTalk::kBoardWords);
  EXPECT_EQ(TalkOf("/robot1/arm/nws/rpc:i", JointsTable()), YarpTalk::kBoardRpc);
  EXPECT_EQ(TalkOf("/robot1/arm/command:i", JointsTable()), YarpTalk::kBoardStream);
  EXPECT_EQ(ParseYarpPortName("/robot1/arm/nws/rpc:i")->module, "/robot1/arm");
}

TEST(TalkOf, CamerasAndBatteriesHaveThePortsOfTheirDevices) {
  EXPECT_EQ(TalkOf("/robot1/eye/rpc", CameraTable()), YarpTalk::kCamera);
  EXPECT_EQ(TalkOf("/robot1/eye/rpc:i", CameraTable()), YarpTalk::kCamera);
  EXPECT_EQ(TalkOf("/robot1/battery/rpc:i", BatteryTable()), YarpTalk::kBattery);
}

TEST(TalkOf, ModulesHaveTheirOwnWords) {
  for (const char* const port : {"/robot1/motors", "/robot1/motors/command:i"})
    EXPECT_EQ(TalkOf(port, MotorsTable()), YarpTalk::kModule) << port;
}

TEST(TalkOf, NothingElseHasThePortsOfADevice) {
  EXPECT_FALSE(TalkOf("/robot1/motors/nws/rpc:i", MotorsTable()));
  EXPECT_FALSE(TalkOf("/robot1/pose/rpc:i", PoseTable()));
  EXPECT_FALSE(TalkOf("/robot1/distance/rpc:o", DistanceTable()));
  EXPECT_FALSE(StreamOf("/robot1/motors/stateExt:o", MotorsTable()));
}

TEST(StreamOf, SensorsSendAsTheirDevicesDo) {
  EXPECT_EQ(StreamOf("/robot1/lidar", LidarTable())->sample, YarpSample::kLaserScan);
  EXPECT_EQ(StreamOf("/robot1/lidar/state:o", LidarTable())->sample, YarpSample::kReading);
  EXPECT_EQ(StreamOf("/robot1/eye", CameraTable())->sample, YarpSample::kImage);
  EXPECT_EQ(StreamOf("/robot1/eye/10/depth:o", CameraTable())->sample, YarpSample::kDepth);
  EXPECT_EQ(StreamOf("/robot1/eye/rgbImage:o", CameraTable())->sample, YarpSample::kImage);
  EXPECT_EQ(StreamOf("/robot1/eye/depthImage:o", CameraTable())->sample, YarpSample::kDepth);
  EXPECT_EQ(StreamOf("/robot1/battery/data:o", BatteryTable())->sample, YarpSample::kBattery);
  EXPECT_EQ(StreamOf("/robot1/eye/camera:o", CameraTable())->reading, command::kGetCamera);
  EXPECT_EQ(StreamOf("/robot1/imu/measures:o", ImuTable())->sample, YarpSample::kMeasures);
  EXPECT_EQ(StreamOf("/robot1/odometry/odometry:o", OdometryTable())->sample, YarpSample::kOdometry);
}

TEST(YarpPortName, TheBaseIsTheDrive) {
  const auto base = ParseYarpPortName("/robot1/base/command:i");
  ASSERT_TRUE(base);
  EXPECT_TRUE(base->IsOf("/robot1/motors", MotorsTable()));
  EXPECT_FALSE(base->IsOf("/robot2/motors", MotorsTable()));
  EXPECT_FALSE(base->IsOf("/robot1/arm", JointsTable()));
  EXPECT_EQ(TalkOf("/robot1/base/command:i", MotorsTable()), YarpTalk::kBase);
}

}  // namespace
}  // namespace coopdyn
