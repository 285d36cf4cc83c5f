// SPDX-License-Identifier: MIT
// <coopdyn:thruster>, and its errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/model/readers.h"

namespace coopdyn::thruster_reader {
namespace {

using ::testing::HasSubstr;

/// A link turned by 90° to the left; the thruster is in line 3.
std::string TextWith(const std::string& more) {
  return "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"craft\">\n"
         "<link name=\"hull\"><pose>1 0 0.5 0 0 1.5707963267948966</pose><inertial><pose>0.1 0 0 0 0 0</pose>"
         "<mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>"
         "<collision name=\"c\"><geometry><box><size>0.1 0.1 "
         "0.1</size></box></geometry></collision></link>\n" +
         more + "\n</model></sdf>";
}

std::string Jet(const std::string& attributes) {
  return TextWith("<coopdyn:thruster name=\"jet\" link=\"hull\" " + attributes + "/>");
}

struct ReadCraft {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

ReadCraft ReadThrusters(const std::string& text) {
  Diagnostics diagnostics;
  ReadCraft read;
  read.robot = ReadRobotModelText(text, "craft/model.sdf", "craft", diagnostics);
  read.messages = diagnostics.ToString();
  return read;
}

TEST(ThrusterReaderTest, AForceHasADirectionAndAPointOfItsLink) {
  const auto [robot, messages] =
      ReadThrusters(Jet("direction=\"2 0 0\" point=\"0.2 0 0\" max_force_n=\"5\""));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 1u);
  const JointModel& jet = robot->joints[0];
  EXPECT_EQ(jet.kind, JointModel::Kind::kForce);
  EXPECT_TRUE(jet.axis_R.isApprox(Vector3::UnitY(), 1e-9));
  EXPECT_TRUE(jet.p_RJ.isApprox(Vector3(1, 0.2, 0.5), 1e-9));
  EXPECT_EQ(jet.max_effort, 5);
}

TEST(ThrusterReaderTest, WithoutAPointItPushesTheCentreOfMass) {
  const auto [robot, messages] = ReadThrusters(Jet("direction=\"1 0 0\" max_force_n=\"5\""));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->joints[0].p_RJ.isApprox(Vector3(1, 0.1, 0.5), 1e-9));
}

TEST(ThrusterReaderTest, ATorqueTurnsAboutItsDirection) {
  const auto [robot, messages] = ReadThrusters(Jet("direction=\"0 0 1\" max_torque_nm=\"2\""));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].kind, JointModel::Kind::kTorque);
  EXPECT_EQ(robot->joints[0].max_effort, 2);
}

TEST(ThrusterReaderTest, APropellerHasAReaction) {
  const auto [robot, messages] =
      ReadThrusters(Jet("direction=\"0 0 1\" max_force_n=\"5\" torque_per_force_m=\"-0.02\""));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].torque_per_force_m, -0.02);
  EXPECT_THAT(ReadThrusters(Jet("direction=\"0 0 1\" max_torque_nm=\"5\" torque_per_force_m=\"1\"")).messages,
              HasSubstr("'torque_per_force_m' is of a force, a propeller's: write 'max_force_n'"));
}

TEST(ThrusterReaderTest, TheyAreAModuleOfTheirOwn) {
  const auto [robot, messages] = ReadThrusters(Jet("direction=\"1 0 0\" max_force_n=\"5\""));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].module, "thrusters");
  EXPECT_STREQ(robot->actuators[0].type(), "thrusters");
}

TEST(ThrusterReaderTest, ItIsAForceOrATorque) {
  EXPECT_THAT(
      ReadThrusters(Jet("direction=\"1 0 0\"")).messages,
      HasSubstr("model.sdf:3: error: <coopdyn:thruster>: a thruster needs 'max_force_n' or 'max_torque_nm'"));
  EXPECT_THAT(ReadThrusters(Jet("direction=\"1 0 0\" max_force_n=\"5\" max_torque_nm=\"5\"")).messages,
              HasSubstr("not both: write two thrusters"));
}

TEST(ThrusterReaderTest, ADirectionHasALength) {
  EXPECT_THAT(ReadThrusters(Jet("direction=\"0 0 0\" max_force_n=\"5\"")).messages,
              HasSubstr("'direction' has no length"));
}

TEST(ThrusterReaderTest, AnUnknownLinkIsReported) {
  EXPECT_THAT(
      ReadThrusters(
          TextWith("<coopdyn:thruster name=\"jet\" link=\"hul\" direction=\"1 0 0\" max_force_n=\"5\"/>"))
          .messages,
      HasSubstr("there is no link 'hul'; did you mean 'hull'?"));
}

TEST(ThrusterReaderTest, TheirModuleNeedsNoElement) {
  EXPECT_THAT(ReadThrusters(TextWith("<coopdyn:module type=\"thrusters\"/>")).messages,
              HasSubstr("thrusters need no module: <coopdyn:thruster …/> makes one"));
}

TEST(ThrusterReaderTest, AChannelGivesThrustersTheirEffortAlone) {
  EXPECT_THAT(ReadThrusters(TextWith("<coopdyn:thruster name=\"jet\" link=\"hull\" direction=\"1 0 0\" "
                                     "max_force_n=\"5\"/><coopdyn:channel><coopdyn:motor name=\"m\" "
                                     "joint=\"jet\"/></coopdyn:channel><coopdyn:module type=\"channel\"/>"))
                  .messages,
              HasSubstr("a thruster takes mode=\"effort\" only"));
}

}  // namespace
}  // namespace coopdyn::thruster_reader
