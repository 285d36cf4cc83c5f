// SPDX-License-Identifier: MIT
// Our own elements for sensors: their values, accepted elements, and errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "tests/server/model/read_text.h"
#include "tests/server/model/sensor_rig.h"

namespace coopdyn::sensor_rig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SensorElementsTest, APlaceIsThatOfItsLinkAlsoThroughAFixedJoint) {
  const auto imu = Described<ImuModel>("<coopdyn:imu link=\"hand\" pose=\"0.1 0 0 0 0 0\"/>");
  const auto answer = ReadRig("");
  ASSERT_NE(answer.robot, nullptr);
  ASSERT_EQ(answer.robot->links.size(), 3u);
  EXPECT_EQ(answer.robot->links[static_cast<std::size_t>(imu.mount.link)].name, "arm");
  // The hand is turned by 90 degrees, 0.3 m before the arm's origin.
  EXPECT_LT((imu.mount.X_LS.p - Vector3(0.3, 0.1, 0)).norm(), 1e-9);
  EXPECT_NEAR(Heading(imu.mount.X_LS.q), 90 * kPerDegree, 1e-9);
}

TEST(SensorElementsTest, WithoutAnElementAnImuIsExactAndInTheChassis) {
  const auto imu = Described<ImuModel>("");
  EXPECT_EQ(imu.mount.link, 0);
  EXPECT_TRUE(imu.turn_noise[0].exact());
}

TEST(SensorElementsTest, NoiseIsInSiUnits) {
  const auto imu = Described<ImuModel>(
      "<coopdyn:imu turn_noise_stddev=\"0.1\" turn_bias_mean=\"-0.2\" turn_bias_stddev=\"0.3\" "
      "turn_resolution=\"0.4\" "
      "acceleration_noise_stddev=\"0.5\" acceleration_noise_uniform=\"0.6\" "
      "orientation_noise_stddev_deg=\"2\"/>");
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(imu.turn_noise.at(static_cast<std::size_t>(axis)), (ValueNoise{0.1, -0.2, 0.3, 0.4}));
    EXPECT_EQ(imu.acceleration_noise.at(static_cast<std::size_t>(axis)), (ValueNoise{0.5, 0, 0, 0, 0.6}));
  }
  EXPECT_DOUBLE_EQ(imu.orientation_noise_stddev_rad, 2 * kPerDegree);
}

TEST(SensorElementsTest, RateAndDelayAreKept) {
  const auto answer = ReadRig("<coopdyn:imu rate=\"50\" delay=\"0.02\"/>" + ModuleOf("imu"));
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.robot->sensors.at(0).timing, (SensorTiming{50, 0.02}));
}

TEST(SensorElementsTest, OldKindsHaveNoRate) {
  EXPECT_THAT(WrongElement("compass", "<coopdyn:compass rate=\"5\"/>"),
              HasSubstr("rig.sdf:9: error: <coopdyn:compass>: unknown attribute 'rate'"));
}

TEST(SensorElementsTest, AWrenchOnAMovingJointHasItsChildAndWhatHangsOnThat) {
  const auto wrench = Described<WrenchModel>("<coopdyn:wrench joint=\"shoulder\"/>");
  const auto answer = ReadRig("");
  const RobotModel& robot = *answer.robot;
  EXPECT_TRUE(wrench.on_parent);
  EXPECT_EQ(robot.links[static_cast<std::size_t>(wrench.part.link)].name, "arm");
  EXPECT_DOUBLE_EQ(wrench.part.mass_kg, 3);
  EXPECT_LT((wrench.part.X_LI.p - Vector3(0.1, 0, 0)).norm(), 1e-9);
  EXPECT_THAT(wrench.part.collisions, ElementsAre(0, 1));
  ASSERT_EQ(wrench.beyond.size(), 1u);
  EXPECT_EQ(robot.links[static_cast<std::size_t>(wrench.beyond[0])].name, "finger");
  EXPECT_LT((robot.links[static_cast<std::size_t>(wrench.mount.link)].X_RL * wrench.mount.X_LS.p -
             Vector3(0.2, 0, 0.5))
                .norm(),
            1e-9);
}

TEST(SensorElementsTest, AWrenchOnAFixedJointHasThePartOfTheLinkBeyondIt) {
  const auto wrench = Described<WrenchModel>(
      "<coopdyn:wrench joint=\"weld\" direction=\"parent_to_child\" frame=\"parent\"/>");
  EXPECT_FALSE(wrench.on_parent);
  EXPECT_DOUBLE_EQ(wrench.part.mass_kg, 1);
  EXPECT_LT((wrench.part.X_LI.p - Vector3(0.3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((wrench.part.inertia_kg_m2 - Vector3(0.01, 0.01, 0.01)).norm(), 1e-9);
  EXPECT_THAT(wrench.part.collisions, ElementsAre(1));
  EXPECT_EQ(wrench.beyond.size(), 1u);
  EXPECT_NEAR(Heading(wrench.mount.X_LS.q), 0, 1e-9);
  const auto child = Described<WrenchModel>("<coopdyn:wrench joint=\"weld\"/>");
  EXPECT_NEAR(Heading(child.mount.X_LS.q), 90 * kPerDegree, 1e-9);
  const auto sensor =
      Described<WrenchModel>("<coopdyn:wrench joint=\"weld\" frame=\"sensor\" pose=\"0 0 0 0 0 -0.5\"/>");
  EXPECT_NEAR(Heading(sensor.mount.X_LS.q), 90 * kPerDegree - 0.5, 1e-9);
  EXPECT_LT((sensor.mount.X_LS.p - Vector3(0.3, 0, 0)).norm(), 1e-9);
}

TEST(SensorElementsTest, AWrenchInALoopIsRefused) {
  EXPECT_THAT(WrongElement("wrench", RigJoint("loop", "revolute", "base", "finger") +
                                         "<coopdyn:wrench joint=\"knuckle\"/>"),
              HasSubstr("rig.sdf:10: error: <coopdyn:wrench>: joint 'knuckle' is in a closed loop"));
}

TEST(SensorElementsTest, AWrenchOnAJointToTheWorldHasAllThatHangsOnIt) {
  const auto wrench = Described<WrenchModel>(RigJoint("stand", "fixed", "world", "base") +
                                             "<coopdyn:wrench joint=\"stand\"/>");
  EXPECT_EQ(wrench.part.link, 0);
  EXPECT_DOUBLE_EQ(wrench.part.mass_kg, 4);
  EXPECT_EQ(wrench.beyond.size(), 2u);
}

TEST(SensorElementsTest, AWrenchWhoseChildStandsInTheWorldIsRefused) {
  EXPECT_THAT(WrongElement("wrench", RigJoint("nail", "fixed", "world", "finger") +
                                         "<coopdyn:wrench joint=\"knuckle\"/>"),
              HasSubstr("the child of joint 'knuckle' is fixed to the world"));
}

TEST(SensorElementsTest, WrongWordsOfAWrenchAreSaidAllAtOnce) {
  const std::string messages =
      WrongElement("wrench", "<coopdyn:wrench joint=\"elbow\" frame=\"left\" direction=\"down\"/>");
  EXPECT_THAT(messages, HasSubstr("frame is child, parent or sensor, not 'left'"));
  EXPECT_THAT(messages, HasSubstr("not 'down'"));
  EXPECT_THAT(WrongElement("wrench", "<coopdyn:wrench joint=\"elbow\"/>"),
              HasSubstr("rig.sdf:9: error: <coopdyn:wrench>: there is no joint 'elbow'; known are shoulder, "
                        "weld and knuckle"));
}

TEST(SensorElementsTest, ALidarLooksAllRoundWithoutAngles) {
  const auto lidar = Described<LidarModel>("<coopdyn:lidar max_range=\"5\" columns=\"4\"/>");
  EXPECT_EQ(lidar.rays(), 4u);
  EXPECT_DOUBLE_EQ(lidar.first_azimuth_rad, -std::numbers::pi);
  EXPECT_NEAR(lidar.last_azimuth_rad, 90 * kPerDegree, 1e-12);
  EXPECT_EQ(lidar.min_range_m, 0);
  EXPECT_EQ(lidar.max_range_m, 5);
}

TEST(SensorElementsTest, ALidarOfOneRayLooksAhead) {
  const auto lidar = Described<LidarModel>("<coopdyn:lidar max_range=\"5\" columns=\"1\"/>");
  EXPECT_EQ(lidar.first_azimuth_rad, 0);
  EXPECT_EQ(lidar.last_azimuth_rad, 0);
}

TEST(SensorElementsTest, AnElementThatHoldsNothingTellsWhatItHolds) {
  for (const char* wrong : {"<coopdyn:imu><coopdyn:beam/></coopdyn:imu>", "<coopdyn:imu>hello</coopdyn:imu>"})
    EXPECT_THAT(WrongElement("imu", wrong), HasSubstr("holds no elements and no text"));
  EXPECT_TRUE(Described<ImuModel>("<coopdyn:imu><!-- in the middle --></coopdyn:imu>").turn_noise[0].exact());
}

TEST(SensorElementsTest, ALidarMayHaveRows) {
  const auto lidar = Described<LidarModel>(
      "<coopdyn:lidar max_range=\"5\" columns=\"10\" rows=\"3\" first_deg=\"-45\" last_deg=\"45\" "
      "first_elevation_deg=\"-10\" last_elevation_deg=\"20\" noise_stddev=\"0.01\"/>");
  EXPECT_EQ(lidar.rays(), 30u);
  EXPECT_NEAR(lidar.first_elevation_rad, -10 * kPerDegree, 1e-12);
  EXPECT_NEAR(lidar.last_elevation_rad, 20 * kPerDegree, 1e-12);
  EXPECT_EQ(lidar.noise.stddev, 0.01);
}

TEST(SensorElementsTest, WrongLidars) {
  EXPECT_THAT(WrongElement("lidar", "<coopdyn:lidar columns=\"8\"/>"),
              HasSubstr("the attribute 'max_range' is missing"));
  EXPECT_THAT(WrongElement("lidar", "<coopdyn:lidar max_range=\"1\" min_range=\"2\"/>"),
              HasSubstr("the least range must lie below"));
  EXPECT_THAT(WrongElement("lidar", "<coopdyn:lidar max_range=\"1\" first_deg=\"0\"/>"),
              HasSubstr("both 'first_deg' and 'last_deg'"));
  EXPECT_THAT(WrongElement("lidar", "<coopdyn:lidar max_range=\"1\" first_deg=\"9\" last_deg=\"-9\"/>"),
              HasSubstr("must not lie above the last"));
  EXPECT_THAT(
      WrongElement("lidar", "<coopdyn:lidar max_range=\"1\" columns=\"1\" first_deg=\"-9\" last_deg=\"9\"/>"),
      HasSubstr("one column looks one way"));
  EXPECT_THAT(WrongElement("lidar", "<coopdyn:lidar max_range=\"1\" last_elevation_deg=\"9\"/>"),
              HasSubstr("one row looks one way"));
  EXPECT_THAT(WrongElement("lidar", "<coopdyn:lidar max_range=\"1\" rows=\"2\"/>"),
              HasSubstr("all rows look the same way"));
  EXPECT_THAT(WrongElement(
                  "lidar",
                  "<coopdyn:lidar max_range=\"1\" columns=\"2000\" rows=\"2000\" last_elevation_deg=\"5\"/>"),
              HasSubstr("take fewer"));
  EXPECT_THAT(ReadRig(ModuleOf("lidar")).messages,
              HasSubstr("a module 'lidar' needs <coopdyn:lidar max_range=\"4\"/>"));
}

TEST(SensorElementsTest, AContactSensorHasAllShapesOrThoseThatItNames) {
  EXPECT_EQ(Described<ContactModel>("<coopdyn:contact/>").parts.size(), 4u);
  const auto hand = Described<ContactModel>(
      "<coopdyn:contact links=\"hand\" collisions=\"hand::body base::body\" threshold=\"2\"/>");
  ASSERT_EQ(hand.parts.size(), 2u);
  EXPECT_EQ(hand.parts[0].collision, 1u);  // of the arm's link, whose own comes first
  EXPECT_EQ(hand.parts[1].link, 0);
  EXPECT_EQ(hand.threshold_n, 2);
}

TEST(SensorElementsTest, ZonesGoFromRightToLeft) {
  const auto bumper = Described<ContactModel>(
      "<coopdyn:contact><coopdyn:zone bearing_deg=\"60\" opening_deg=\"50\"/><coopdyn:zone "
      "bearing_deg=\"-60\" "
      "opening_deg=\"40\"/></coopdyn:contact>");
  ASSERT_EQ(bumper.zones.size(), 2u);
  EXPECT_NEAR(bumper.zones[0].bearing_rad, -60 * kPerDegree, 1e-12);
  EXPECT_NEAR(bumper.zones[0].opening_rad, 40 * kPerDegree, 1e-12);
}

TEST(SensorElementsTest, WrongContacts) {
  EXPECT_THAT(WrongElement("contact", "<coopdyn:contact links=\"hnd\"/>"),
              HasSubstr("there is no link 'hnd'; did you mean 'hand'?"));
  EXPECT_THAT(WrongElement("contact", "<coopdyn:contact collisions=\"hand::bdy\"/>"),
              HasSubstr("link 'hand' has no collision 'bdy'; did you mean 'body'?"));
  EXPECT_THAT(WrongElement("contact", "<coopdyn:contact collisions=\"body\"/>"),
              HasSubstr("is named with its link"));
  EXPECT_THAT(WrongElement("contact", "<coopdyn:contact><coopdyn:zon/></coopdyn:contact>"),
              HasSubstr("unknown element <coopdyn:zon>; did you mean 'coopdyn:zone'?"));
}

TEST(SensorElementsTest, ABattery) {
  const auto battery = Described<BatteryModel>(
      "<coopdyn:battery capacity=\"1000\" start=\"0.5\" idle=\"3\" efficiency=\"0.8\"/>");
  EXPECT_EQ(battery.capacity_j, 1000);
  EXPECT_EQ(battery.start, 0.5);
  EXPECT_EQ(battery.idle_w, 3);
  EXPECT_EQ(battery.efficiency, 0.8);
  EXPECT_THAT(WrongElement("battery", "<coopdyn:battery/>"),
              HasSubstr("the attribute 'capacity' is missing"));
}

TEST(SensorElementsTest, OdometryNeedsADrive) {
  EXPECT_THAT(WrongElement("odometry", "<coopdyn:odometry/>"),
              HasSubstr("rig.sdf:9: error: <coopdyn:odometry>: needs a <coopdyn:drive>"));
}

TEST(SensorElementsTest, AnElementWithoutItsModuleIsAnError) {
  EXPECT_THAT(
      ReadRig("<coopdyn:imu name=\"chest\"/>").messages,
      HasSubstr("<coopdyn:imu> needs its module: write <coopdyn:module type=\"imu\" name=\"chest\"/>"));
}

// --- the shipped robots that have them

std::shared_ptr<const RobotModel> ShippedRobot(const std::string& type) {
  Diagnostics diagnostics;
  auto robot = ShippedRobots().Get(type, {}, diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return robot;
}

TEST(SensorRobotsTest, TheTurtleHasLidarDepthCameraBumperImuBatteryAndOdometry) {
  const auto turtle = ShippedRobot("turtle");
  ASSERT_NE(turtle, nullptr);
  EXPECT_EQ(turtle->Find<LidarModel>()->rays(), 360u);
  EXPECT_EQ(turtle->Find<ContactModel>()->zones.size(), 3u);
  EXPECT_NE(turtle->Find<CameraModel>(), nullptr);
  EXPECT_NE(turtle->Find<ImuModel>(), nullptr);
  EXPECT_NE(turtle->Find<BatteryModel>(), nullptr);
  EXPECT_NEAR(turtle->Find<OdometryModel>()->resolution_rad * 2578.33, 2 * std::numbers::pi, 1e-3);
  // The lidar is above all collisions, so it does not see the robot.
  EXPECT_GT(turtle->Find<LidarModel>()->mount.X_LS.p.z(), turtle->height_m);
}

TEST(SensorRobotsTest, TheCoopbotWithACameraIsACoopbot) {
  const auto robot = ShippedRobot("coopbot_camera"), plain = ShippedRobot("coopbot");
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->sectors().size(), plain->sectors().size());
  EXPECT_EQ(robot->drive()->track_m, plain->drive()->track_m);
  EXPECT_EQ(robot->footprint_radius_m, plain->footprint_radius_m);
  EXPECT_EQ(robot->links.size(), plain->links.size());
  ASSERT_NE(robot->Find<CameraModel>(), nullptr);
  EXPECT_EQ(robot->Find<CameraModel>()->mount.link, 0);
  EXPECT_LT((robot->Find<CameraModel>()->mount.X_LS.p - Vector3(0.156, 0, 0.28)).norm(), 1e-9);
}

TEST(SensorRobotsTest, TheHumanoidWeighsItselfByItsAnkles) {
  const auto robot = ShippedRobot("humanoid");
  ASSERT_NE(robot, nullptr);
  ASSERT_NE(robot->Find<WrenchModel>(1), nullptr);
  const WrenchModel& left = *robot->Find<WrenchModel>(0);
  EXPECT_EQ(left.joint, "left_ankle_roll");
  EXPECT_TRUE(left.beyond.empty());
  EXPECT_EQ(robot->links[static_cast<std::size_t>(left.part.link)].name, "left_foot");
  EXPECT_NE(robot->Find<ImuModel>(2), nullptr);
}

TEST(SensorRobotsTest, TheArmWeighsWhatItsFlangeHolds) {
  const auto robot = ShippedRobot("lwa");
  ASSERT_NE(robot, nullptr);
  ASSERT_NE(robot->Find<WrenchModel>(), nullptr);
  EXPECT_FALSE(robot->Find<WrenchModel>()->on_parent);
  EXPECT_DOUBLE_EQ(robot->Find<WrenchModel>()->part.mass_kg, 0.3);
  EXPECT_TRUE(robot->Find<WrenchModel>()->beyond.empty());
}

}  // namespace
}  // namespace coopdyn::sensor_rig
