// SPDX-License-Identifier: MIT
// <sensor> of SDF and of URDF's <gazebo>: each makes a module.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "server/model/values.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

struct SdfAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

SdfAnswer ReadSdfModel(const std::string& text) {
  Diagnostics diagnostics;
  SdfAnswer answer;
  answer.robot = ReadRobotModelText(text, "rig.sdf", "rig", diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}

std::string SensorLink(const std::string& name, const std::string& pose, const std::string& inside = "") {
  return "<link name=\"" + name + "\"><pose>" + pose +
         "</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></"
         "inertial>"
         "<collision name=\"body\"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>" +
         inside + "</link>";
}
/// A base with a fixed head; `sensor` is in the head's link, at line 2.
SdfAnswer ReadHead(const std::string& sensor, const std::string& version = "1.9", bool own = false) {
  return ReadSdfModel(std::string("<sdf version=\"") + version + "\"" +
                      (own ? " xmlns:coopdyn=\"https://coopdyn.dev/sdf\"" : "") + "><model name=\"rig\">\n" +
                      SensorLink("head", "0 0 0.4 0 0 0", sensor) + SensorLink("base", "0 0 0.1 0 0 0") +
                      "<joint name=\"neck\" type=\"fixed\"><parent>base</parent><child>head</child></joint>" +
                      (own ? "<coopdyn:module type=\"pose\"/>" : "") + "</model></sdf>");
}
template <typename Kind>
Kind SdfSensorOf(const std::string& sensor, const std::string& version = "1.9") {
  const SdfAnswer answer = ReadHead(sensor, version);
  EXPECT_EQ(answer.messages, "");
  if (answer.robot == nullptr || answer.robot->Find<Kind>() == nullptr) return {};
  return *answer.robot->Find<Kind>();
}

TEST(SdfSensorsTest, AnImuHasItsNoiseAxisByAxis) {
  const auto imu = SdfSensorOf<ImuModel>(
      "<sensor name=\"imu\" type=\"imu\"><imu><angular_velocity><x><noise "
      "type=\"gaussian\"><mean>0.1</mean><stddev>0.2</stddev><bias_mean>0.3</bias_mean><bias_stddev>0.4</"
      "bias_stddev></"
      "noise></x></angular_velocity><linear_acceleration><z><noise "
      "type=\"gaussian_quantized\"><stddev>0.5</stddev><precision>0.6</precision></noise></z></"
      "linear_acceleration></imu></sensor>");
  EXPECT_EQ(imu.turn_noise[0], (ValueNoise{0.2, 0.4, 0.4, 0}));
  EXPECT_TRUE(imu.turn_noise[1].exact());
  EXPECT_EQ(imu.acceleration_noise[2], (ValueNoise{0.5, 0, 0, 0.6}));
}

TEST(SdfSensorsTest, AnImuOfSdf14HasOneNoiseForAllAxes) {
  const auto imu = SdfSensorOf<ImuModel>(
      "<sensor name=\"imu\" "
      "type=\"imu\"><imu><noise><type>gaussian</type><rate><mean>0</mean><stddev>0.2</stddev></rate>"
      "<accel><mean>0</mean><stddev>0.3</stddev></accel></noise></imu></sensor>",
      "1.4");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(imu.turn_noise.at(axis).stddev, 0.2);
    EXPECT_EQ(imu.acceleration_noise.at(axis).stddev, 0.3);
  }
}

TEST(SdfSensorsTest, ASensorGoesWithItsLinkThroughAFixedJoint) {
  const auto imu =
      SdfSensorOf<ImuModel>("<sensor name=\"imu\" type=\"imu\"><pose>0.05 0 0.1 0 0 0.5</pose></sensor>");
  EXPECT_EQ(imu.mount.link, 0);
  EXPECT_LT((imu.mount.X_LS.p - Vector3(0.05, 0, 0.4)).norm(), 1e-9);
  EXPECT_NEAR(Heading(imu.mount.X_LS.q), 0.5, 1e-9);
}

TEST(SdfSensorsTest, APoseMayBeRelativeToAnotherFrame) {
  const auto imu = SdfSensorOf<ImuModel>(
      "<sensor name=\"imu\" type=\"imu\"><pose relative_to=\"base\">0 0.2 0 0 0 0</pose></sensor>");
  EXPECT_LT((imu.mount.X_LS.p - Vector3(0, 0.2, 0)).norm(), 1e-9);
}

TEST(SdfSensorsTest, TheModuleIsCalledLikeTheSensorAndHasItsRate) {
  const auto answer = ReadHead(
      "<sensor name=\"Front IMU-1\" type=\"imu\"><update_rate>100</update_rate><always_on>1</always_on>"
      "<visualize>true</visualize><topic>imu</topic></sensor><sensor name=\"front_imu_1\" type=\"imu\"/>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.messages, "");
  ASSERT_EQ(answer.robot->sensors.size(), 3u);  // the first: pose
  EXPECT_EQ(answer.robot->sensors[1].name, "front_imu_1");
  EXPECT_EQ(answer.robot->sensors[1].timing.rate_hz, 100);
  EXPECT_EQ(answer.robot->sensors[2].name, "front_imu_1_2");
}

TEST(SdfSensorsTest, AModelOfOurOwnMayHaveThemToo) {
  const auto answer = ReadHead("<sensor name=\"imu\" type=\"imu\"/>", "1.9", true);
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_NE(answer.robot->Find<ImuModel>(), nullptr);
}

const std::string kScan =
    "<scan><horizontal><samples>181</samples><resolution>1</resolution><min_angle>-1.57</"
    "min_angle><max_angle>1.57</max_angle>"
    "</horizontal></scan><range><min>0.1</min><max>8</max><resolution>0.01</resolution></range>"
    "<noise><type>gaussian</type><mean>0</mean><stddev>0.02</stddev></noise>";

TEST(SdfSensorsTest, LidarsOfAllNames) {
  for (const char* type : {"ray", "gpu_ray", "lidar", "gpu_lidar"}) {
    for (const char* element : {"ray", "lidar"}) {
      const auto lidar = SdfSensorOf<LidarModel>(std::string("<sensor name=\"l\" type=\"") + type + "\"><" +
                                                 element + ">" + kScan + "</" + element + "></sensor>");
      EXPECT_EQ(lidar.columns, 181);
      EXPECT_EQ(lidar.rows, 1);
      EXPECT_EQ(lidar.first_azimuth_rad, -1.57);
      EXPECT_EQ(lidar.last_azimuth_rad, 1.57);
      EXPECT_EQ(lidar.min_range_m, 0.1);
      EXPECT_EQ(lidar.max_range_m, 8);
      EXPECT_EQ(lidar.noise, (ValueNoise{0.02, 0, 0, 0.01}));
    }
  }
}

TEST(SdfSensorsTest, ALidarWithRows) {
  const auto lidar = SdfSensorOf<LidarModel>(
      "<sensor name=\"l\" "
      "type=\"gpu_lidar\"><lidar><scan><horizontal><samples>100</samples><resolution>2</"
      "resolution><min_angle>-3</"
      "min_angle><max_angle>3</max_angle></horizontal><vertical><samples>16</samples><min_angle>-0.2</"
      "min_angle><max_angle>0.3"
      "</max_angle></vertical></scan><range><min>0.1</min><max>inf</max></range></lidar></sensor>");
  EXPECT_EQ(lidar.columns, 200);
  EXPECT_EQ(lidar.rows, 16);
  EXPECT_EQ(lidar.first_elevation_rad, -0.2);
  EXPECT_EQ(lidar.last_elevation_rad, 0.3);
}

TEST(SdfSensorsTest, AnglesThatAreTheWrongWayRoundAreTurned) {
  const auto answer = ReadHead(
      "<sensor name=\"l\" type=\"ray\"><ray><scan><horizontal><samples>3</samples><min_angle>1</min_angle>"
      "<max_angle>-2</max_angle></horizontal>\n<vertical><samples>2</samples><min_angle>-0.1</min_angle>"
      "<max_angle>-0.3</max_angle></vertical></scan><range><max>5</max></range></ray></sensor>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_THAT(answer.messages,
              HasSubstr("rig.sdf:2: warning: sensor 'l': <min_angle> lies above <max_angle>"));
  EXPECT_THAT(answer.messages,
              HasSubstr("rig.sdf:3: warning: sensor 'l': <min_angle> lies above <max_angle>"));
  EXPECT_EQ(answer.robot->Find<LidarModel>()->first_azimuth_rad, -2);
  EXPECT_EQ(answer.robot->Find<LidarModel>()->last_azimuth_rad, 1);
  EXPECT_EQ(answer.robot->Find<LidarModel>()->first_elevation_rad, -0.3);
}

TEST(SdfSensorsTest, ForceAndTorqueAreThoseOfTheJoint) {
  const auto read = [](const std::string& inside) {
    return ReadSdfModel(
        "<sdf version=\"1.6\"><model name=\"rig\">\n" + SensorLink("base", "0 0 0.1 0 0 0") +
        SensorLink("head", "0 0 0.4 0 0 1") +
        "<joint name=\"neck\" type=\"revolute\"><pose>0 0 -0.1 0 0 "
        "0.5</pose><parent>base</parent><child>head</child>"
        "<axis><xyz>0 0 1</xyz></axis>\n<sensor name=\"ft\" type=\"force_torque\"><force_torque>" +
        inside + "</force_torque></sensor></joint></model></sdf>");
  };
  const auto heading = [](const SdfAnswer& answer) {
    const WrenchModel& wrench = *answer.robot->Find<WrenchModel>();
    const Mount& mount = wrench.mount;
    EXPECT_LT(
        (answer.robot->links[static_cast<std::size_t>(mount.link)].X_RL * mount.X_LS.p - Vector3(0, 0, 0.3))
            .norm(),
        1e-9);
    return Heading(answer.robot->links[static_cast<std::size_t>(mount.link)].X_RL.q * mount.X_LS.q);
  };
  const SdfAnswer usual = read("");
  ASSERT_NE(usual.robot, nullptr) << usual.messages;
  EXPECT_TRUE(usual.robot->Find<WrenchModel>()->on_parent);
  EXPECT_EQ(usual.robot->Find<WrenchModel>()->joint, "neck");
  EXPECT_NEAR(heading(usual), 1, 1e-9);
  EXPECT_NEAR(heading(read("<frame>parent</frame>")), 0, 1e-9);
  EXPECT_NEAR(heading(read("<frame>sensor</frame>")), 1.5, 1e-9);
  EXPECT_FALSE(
      read("<measure_direction>parent_to_child</measure_direction>").robot->Find<WrenchModel>()->on_parent);
  EXPECT_THAT(read("<frame>world</frame>").messages,
              HasSubstr("rig.sdf:3: error: sensor 'ft': <frame> is child, parent or sensor, not 'world'"));
}

TEST(SdfSensorsTest, AContactSensorHasTheCollisionsThatItNames) {
  const auto contact = SdfSensorOf<ContactModel>(
      "<sensor name=\"bumper\" type=\"contact\"><contact><collision>body</collision></contact></sensor>");
  ASSERT_EQ(contact.parts.size(), 1u);
  EXPECT_EQ(contact.parts[0].collision, 1u);  // after the base's collision
  const auto other = ReadHead(
      "<sensor name=\"bumper\" "
      "type=\"contact\"><contact><collision>lump_collision</collision></contact></sensor>");
  EXPECT_THAT(other.messages, HasSubstr("rig.sdf:2: warning: sensor 'bumper': link 'head' has no collision "
                                        "'lump_collision'; known are body: "
                                        "all shapes of the link are taken"));
  ASSERT_NE(other.robot, nullptr);
  EXPECT_EQ(other.robot->Find<ContactModel>()->parts.size(), 1u);
}

TEST(SdfSensorsTest, ASonar) {
  const auto sonar = SdfSensorOf<SonarModel>(
      "<sensor name=\"s\" "
      "type=\"sonar\"><sonar><min>0.1</min><max>4</max><radius>1</radius></sonar></sensor>");
  ASSERT_EQ(sonar.beams.size(), 1u);
  EXPECT_EQ(sonar.beams[0].max_range_m, 4);
  EXPECT_NEAR(sonar.beams[0].opening_rad, 2 * std::atan(0.25), 1e-12);
}

TEST(SdfSensorsTest, CamerasOfAllKinds) {
  const std::string inside =
      "<camera><horizontal_fov>1.5</horizontal_fov><image><width>64</width><height>48</height></"
      "image><clip><near>0.2</near>"
      "<far>9</far></clip><noise><type>gaussian</type><stddev>0.07</stddev></noise></camera>";
  for (const char* type : {"camera", "rgbd_camera", "segmentation_camera", "depth_camera", "depth"}) {
    const auto camera = SdfSensorOf<CameraModel>(std::string("<sensor name=\"c\" type=\"") + type + "\">" +
                                                 inside + "</sensor>");
    EXPECT_EQ(camera.width, 64);
    EXPECT_EQ(camera.height, 48);
    EXPECT_EQ(camera.horizontal_fov_rad, 1.5);
    EXPECT_EQ(camera.near_m, 0.2);
    EXPECT_EQ(camera.far_m, 9);
    const bool depth = type[0] == 'd';
    EXPECT_EQ(camera.noise.stddev, depth ? 0 : 0.07) << type;
    EXPECT_EQ(camera.depth_noise.stddev, depth ? 0.07 : 0) << type;
  }
}

TEST(SdfSensorsTest, AnAngleOfViewThatPicturesCannotHaveIsTheNearestThatTheyCan) {
  for (const auto& [given, taken] : {std::pair("0.088", 0.1), {"0.2", 0.2}, {"3", 3.0}, {"6.28", 3.05}}) {
    const auto answer =
        ReadSdf("<link name=\"l\"><sensor name=\"c\" type=\"camera\"><camera><horizontal_fov>" +
                std::string(given) + "</horizontal_fov></camera></sensor></link>");
    ASSERT_NE(answer.robot, nullptr) << answer.messages;
    EXPECT_EQ(answer.robot->Find<CameraModel>()->horizontal_fov_rad, taken);
    EXPECT_EQ(answer.messages.find("<horizontal_fov> lies between") != std::string::npos,
              given != FormatNumber(taken));
  }
}

TEST(SdfSensorsTest, ACameraWithoutAWordHasSdfsDefaults) {
  const auto camera = SdfSensorOf<CameraModel>("<sensor name=\"c\" type=\"camera\"/>");
  EXPECT_EQ(camera.width, 320);
  EXPECT_EQ(camera.height, 240);
  EXPECT_EQ(camera.horizontal_fov_rad, 1.047);
  EXPECT_EQ(camera.near_m, 0.1);
  EXPECT_EQ(camera.far_m, 100);
}

TEST(SdfSensorsTest, AMulticameraIsOneModuleForEachCamera) {
  const auto answer = ReadHead(
      "<sensor name=\"stereo\" type=\"multicamera\"><camera name=\"left\"><pose>0 0.1 0 0 0 "
      "0</pose></camera><camera "
      "name=\"right\"><pose>0 -0.1 0 0 0 0</pose></camera></sensor>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  ASSERT_EQ(answer.robot->sensors.size(), 3u);
  EXPECT_EQ(answer.robot->sensors[1].name, "stereo_left");
  EXPECT_EQ(answer.robot->sensors[2].name, "stereo_right");
  EXPECT_NEAR(answer.robot->Find<CameraModel>(1)->mount.X_LS.p.y(), -0.1, 1e-9);
}

TEST(SdfSensorsTest, WhatCoopdynHasNotIsSaidWithItsLine) {
  const auto answer = ReadHead(
      "<sensor name=\"g\" type=\"gps\"/><sensor name=\"c\" type=\"wideanglecamera\"/>\n<sensor name=\"i\" "
      "type=\"imu\"><plugin "
      "name=\"p\" filename=\"libp.so\"/></sensor>");
  ASSERT_NE(answer.robot, nullptr);
  EXPECT_THAT(answer.messages,
              HasSubstr("rig.sdf:2: warning: <sensor type=\"gps\"> in <link> is not used by coopdyn"));
  EXPECT_THAT(
      answer.messages,
      HasSubstr("rig.sdf:2: warning: <sensor type=\"wideanglecamera\"> in <link> is not used by coopdyn"));
  EXPECT_THAT(answer.messages, HasSubstr("rig.sdf:3: warning: <plugin> in <sensor> is not used by coopdyn"));
  EXPECT_NE(answer.robot->Find<ImuModel>(), nullptr);
}

TEST(SdfSensorsTest, InAModelOfOurOwnAMisspeltTypeIsAnError) {
  EXPECT_THAT(ReadHead("<sensor name=\"g\" type=\"lidr\"/>", "1.9", true).messages,
              HasSubstr("rig.sdf:2: error: unknown type 'lidr' of <sensor>; did you mean 'lidar'?"));
}

TEST(SdfSensorsTest, WrongValuesAreSaidAllAtOnceWithTheirLines) {
  const auto answer = ReadHead(
      "\n<sensor name=\"a\" "
      "type=\"ray\"><ray><scan><horizontal>\n<samples>0</samples><min_angle>1</min_angle><max_angle>-1</"
      "max_angle></horizontal></scan>"
      "<range><min>2</min>\n<max>1</max></range></ray></sensor>\n<sensor name=\"b\" "
      "type=\"camera\"><camera><horizontal_fov>6</horizontal_fov><clip><near>9</near><far>2</far></clip></"
      "camera></sensor>"
      "\n<sensor name=\"c\" type=\"imu\"><update_rate>-1</update_rate></sensor>\n<sensor name=\"d\" "
      "type=\"force_torque\"/>"
      "\n<sensor name=\"e\" type=\"ray\"><ray><noise><type>white</type></noise></ray></sensor>");
  EXPECT_EQ(answer.robot, nullptr);
  EXPECT_THAT(
      answer.messages,
      HasSubstr("rig.sdf:4: error: sensor 'a': <samples> must be a number from 1 to 1000000, not '0'"));
  EXPECT_THAT(answer.messages,
              HasSubstr("rig.sdf:3: error: sensor 'a': the least range must lie below the largest"));
  EXPECT_THAT(answer.messages, HasSubstr("rig.sdf:6: error: sensor 'b': the camera needs 0 < near < far"));
  EXPECT_THAT(
      answer.messages,
      HasSubstr("rig.sdf:7: error: sensor 'c': <update_rate> must be a number from 0 to 1000000, not '-1'"));
  EXPECT_THAT(answer.messages,
              HasSubstr("rig.sdf:8: warning: <sensor type=\"force_torque\"> in <link> is not used"));
  EXPECT_THAT(answer.messages, HasSubstr("rig.sdf:9: error: sensor 'e': needs <range><max>, in m"));
}

TEST(SdfSensorsTest, SensorsOfUrdfStandInGazeboElements) {
  const std::string link =
      "\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial><collision name=\"body\"><geometry><box size=\"0.2 0.2 "
      "0.2\"/></geometry></collision></link>";
  const auto answer =
      ReadSdfModel("<robot name=\"rig\"><link name=\"base" + link + "<link name=\"head" + link +
                   "<joint name=\"neck\" type=\"continuous\"><parent link=\"base\"/><child "
                   "link=\"head\"/><origin xyz=\"0 0 0.5\"/></joint>"
                   "<gazebo reference=\"head\"><sensor name=\"eye\" "
                   "type=\"camera\"><update_rate>10</update_rate><pose>0.1 0 0 0 0 0</pose></sensor></gazebo>"
                   "<gazebo reference=\"neck\"><sensor name=\"ft\" type=\"force_torque\"/></gazebo></robot>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_THAT(answer.messages, Not(HasSubstr("sensor")));
  ASSERT_NE(answer.robot->Find<CameraModel>(), nullptr);
  EXPECT_EQ(answer.robot->Find<CameraModel>()->mount.link, 1);
  EXPECT_NEAR(answer.robot->Find<CameraModel>()->mount.X_LS.p.x(), 0.1, 1e-9);
  ASSERT_NE(answer.robot->Find<WrenchModel>(), nullptr);
  EXPECT_EQ(answer.robot->Find<WrenchModel>()->joint, "neck");
}

TEST(SdfSensorsTest, InNestedModelsTheyHaveTheirLink) {
  const auto answer =
      ReadSdfModel("<sdf version=\"1.8\"><model name=\"rig\">" + SensorLink("base", "0 0 0.1 0 0 0") +
                   "<model name=\"arm\"><pose>0 0 1 0 0 0</pose>" +
                   SensorLink("hand", "0.5 0 0 0 0 0",
                              "<sensor name=\"imu\" type=\"imu\"><pose>0 0.1 0 0 0 0</pose></sensor>") +
                   "</model><joint name=\"j\" "
                   "type=\"fixed\"><parent>base</parent><child>arm::hand</child></joint></model></sdf>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  ASSERT_NE(answer.robot->Find<ImuModel>(), nullptr);
  EXPECT_LT((answer.robot->Find<ImuModel>()->mount.X_LS.p - Vector3(0.5, 0.1, 0.9)).norm(), 1e-9);
}

TEST(SdfSensorsTest, ARecordingsTextGivesThemAgain) {
  const auto first =
      ReadHead("<sensor name=\"imu\" type=\"imu\"><update_rate>5</update_rate></sensor>", "1.4");
  ASSERT_NE(first.robot, nullptr);
  const auto again = ReadSdfModel(first.robot->text);
  ASSERT_NE(again.robot, nullptr) << again.messages;
  ASSERT_EQ(again.robot->sensors.size(), first.robot->sensors.size());
  EXPECT_EQ(again.robot->sensors.back().timing.rate_hz, 5);
}

}  // namespace
}  // namespace coopdyn
