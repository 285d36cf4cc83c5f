// SPDX-License-Identifier: MIT
// <coopdyn:muscle>, and its errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/model/readers.h"

namespace coopdyn::muscle_reader {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPlaces =
    "from=\"a\" from_point=\"0 0 0.1\" to=\"b\" to_point=\"0.1 0 0\" max_force_n=\"30\" "
    "optimal_length_m=\"0.5\" ";

/// Two links joined only by muscles; the first muscle is in line 3.
std::string MuscleText(const std::string& muscles, bool fixed = true) {
  const auto link = [](const char* name, const char* pose) {
    return std::string("<link name=\"") + name + "\"><pose>" + pose +
           "</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
           "</inertial><collision name=\"c\"><geometry><box><size>0.1 0.1 "
           "0.1</size></box></geometry></collision>"
           "</link>";
  };
  return "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">\n" +
         link("a", "0 0 2 0 0 0") + link("b", "0 0 1 0 0 0") +
         (fixed ? "<joint name=\"post\" type=\"fixed\"><parent>world</parent><child>a</child></joint>" : "") +
         "\n" + muscles + "\n</model></sdf>";
}

std::string MuscleLine(const std::string& attributes, const std::string& places = kPlaces) {
  return "<coopdyn:muscle name=\"m\" " + places + attributes + "/>";
}

struct ReadMuscles {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

ReadMuscles ReadText(const std::string& text) {
  Diagnostics diagnostics;
  ReadMuscles read;
  read.robot = ReadRobotModelText(text, "rig/model.sdf", "rig", diagnostics);
  read.messages = diagnostics.ToString();
  return read;
}

TEST(MuscleReaderTest, EveryAttributeIsRead) {
  const auto [robot, messages] =
      ReadText(MuscleText(MuscleLine("width=\"0.6\" c=\"2\" max_velocity_m_s=\"4\" eccentric=\"1.4\" "
                                     "curvature=\"6\" use_length=\"false\"")));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 1u);
  ASSERT_TRUE(robot->joints[0].muscle);
  const MuscleModel& muscle = *robot->joints[0].muscle;
  EXPECT_EQ(muscle.p_from_R, Vector3(0, 0, 2.1));
  EXPECT_EQ(muscle.p_to_R, Vector3(0.1, 0, 1));
  EXPECT_EQ(muscle.max_force_n, 30);
  EXPECT_EQ(muscle.optimal_length_m, 0.5);
  EXPECT_EQ(muscle.width, 0.6);
  EXPECT_EQ(muscle.c, 2);
  EXPECT_EQ(muscle.max_velocity_m_s, 4);
  EXPECT_EQ(muscle.eccentric, 1.4);
  EXPECT_EQ(muscle.curvature, 6);
  EXPECT_FALSE(muscle.use_length);
  EXPECT_TRUE(muscle.use_velocity);
}

TEST(MuscleReaderTest, TheMusclesOfARobotAreOneModule) {
  const std::string second =
      "<coopdyn:muscle name=\"n\" " + std::string(kPlaces) + "use_velocity=\"false\"/>";
  const auto [robot, messages] = ReadText(MuscleText(MuscleLine("use_velocity=\"false\"") + second));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].module, "muscles");
  EXPECT_STREQ(robot->actuators[0].type(), "muscles");
  EXPECT_EQ(robot->actuators[0].joints.size(), 2u);
}

TEST(MuscleReaderTest, AMuscleCanHangOnTheWorldOfAFixedRobot) {
  const std::string places =
      "from=\"world\" from_point=\"0 0 3\" to=\"b\" max_force_n=\"30\" optimal_length_m=\"0.5\" ";
  const auto [robot, messages] =
      ReadText(MuscleText(MuscleLine("use_velocity=\"false\"", places) + "<coopdyn:muscle name=\"n\" " +
                          kPlaces + "use_velocity=\"false\"/>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].parent, 0);
  EXPECT_EQ(robot->joints[0].muscle->p_from_R, Vector3(0, 0, 3));
}

TEST(MuscleReaderTest, HostileValuesAreErrorsAtTheirLine) {
  for (const char* attribute :
       {"max_velocity_m_s=\"-1\"", "max_velocity_m_s=\"nan\"", "", "max_velocity_m_s=\"1\" width=\"0\"",
        "max_velocity_m_s=\"1\" c=\"-1\"", "max_velocity_m_s=\"1\" eccentric=\"0.5\"",
        "max_velocity_m_s=\"1\" curvature=\"inf\"", "max_velocity_m_s=\"1\" use_length=\"yes\"",
        "max_velocity_m_s=\"1\" wrong=\"1\""}) {
    const auto [robot, messages] = ReadText(MuscleText(MuscleLine(attribute)));
    EXPECT_EQ(robot, nullptr) << attribute;
    EXPECT_THAT(messages, HasSubstr("rig/model.sdf:3: error: <coopdyn:muscle>")) << attribute;
  }
}

TEST(MuscleReaderTest, AMuscleNeedsTwoBodies) {
  const std::string places = "from=\"b\" to=\"b\" max_force_n=\"30\" optimal_length_m=\"0.5\" ";
  EXPECT_THAT(ReadText(MuscleText(MuscleLine("use_velocity=\"false\"") + "<coopdyn:muscle name=\"n\" " +
                                  places + "use_velocity=\"false\"/>"))
                  .messages,
              HasSubstr("'from' and 'to' are one body"));
}

TEST(MuscleReaderTest, TwoMusclesHaveTwoNames) {
  const std::string one = MuscleLine("use_velocity=\"false\"");
  EXPECT_THAT(ReadText(MuscleText(one + one)).messages, HasSubstr("another joint, muscle or thruster 'm'"));
}

TEST(MuscleReaderTest, AFreeRobotHasNoneToTheWorld) {
  const std::string places = "from=\"world\" to=\"b\" max_force_n=\"30\" optimal_length_m=\"0.5\" ";
  EXPECT_THAT(ReadText(MuscleText(MuscleLine("use_velocity=\"false\"") + "<coopdyn:muscle name=\"n\" " +
                                      places + "use_velocity=\"false\"/>",
                                  false))
                  .messages,
              HasSubstr("only a robot that is fixed to the world has muscles to 'world'"));
}

}  // namespace
}  // namespace coopdyn::muscle_reader
