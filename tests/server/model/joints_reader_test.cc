// SPDX-License-Identifier: MIT
// Joints of a model: fixed ones, axes with stops, springs and dampers, and their errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

struct Answer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

Answer ReadParts(const std::string& parts) {
  Diagnostics diagnostics;
  Answer answer;
  answer.robot = ReadRobotModelText(
      "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">\n" + parts +
          "<coopdyn:module type=\"pose\"/></model></sdf>",
      "rig/model.sdf", "rig", diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}

/// A cube of 2 kg and 0.1 m edge.
std::string Cube(const std::string& name, const std::string& pose) {
  return "<link name=\"" + name + "\"><pose>" + pose +
         "</pose><inertial><mass>2</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></"
         "inertial>"
         "<collision name=\"c\"><geometry><box><size>0.1 0.1 "
         "0.1</size></box></geometry></collision></link>\n";
}

std::string Joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& axis = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent>" + parent + "</parent><child>" + child +
         "</child>" + (axis.empty() ? "" : "<axis>" + axis + "</axis>") + "</joint>\n";
}

const std::string kUp = "<xyz>0 0 1</xyz>";

TEST(JointsReaderTest, FixedJointsMakeOneLinkOfTheirLinks) {
  const auto [robot, messages] =
      ReadParts(Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0.4 0 0.1 0 0 0") + Joint("weld", "fixed", "a", "b"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 1u);
  const LinkModel& link = robot->links[0];
  EXPECT_EQ(link.name, "a");
  EXPECT_DOUBLE_EQ(link.mass_kg, 4);
  EXPECT_NEAR((link.X_LI.p - Vector3(0.2, 0, 0)).norm(), 0, 1e-12);
  // About the common centre: the cubes' moments, and twice m d² with d = 0.2 m perpendicular to the line
  // between them.
  const Matrix3 R = link.X_LI.q.toRotationMatrix();
  const Matrix3 inertia = R * link.inertia_kg_m2.asDiagonal() * R.transpose();
  EXPECT_NEAR((inertia - Matrix3(Vector3(0.02, 0.18, 0.18).asDiagonal())).norm(), 0, 1e-12);
  ASSERT_EQ(link.collisions.size(), 2u);
  EXPECT_NEAR((link.collisions[1].X_LG.p - Vector3(0.4, 0, 0)).norm(), 0, 1e-12);
}

TEST(JointsReaderTest, JointsOfAWeldedLinkAreThoseOfTheWhole) {
  const auto [robot, messages] =
      ReadParts(Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0.4 0 0.1 0 0 0") + Cube("c", "0.8 0 0.1 0 0 0") +
                Joint("weld", "fixed", "a", "b") + Joint("turn", "continuous", "b", "c", kUp));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 2u);
  EXPECT_EQ(robot->joints[0].parent, 0);
  EXPECT_EQ(robot->links[static_cast<std::size_t>(robot->joints[0].child)].name, "c");
}

TEST(JointsReaderTest, AWeldedLinkMayHaveNoMass) {
  const auto [robot, messages] =
      ReadParts(Cube("a", "0 0 0.1 0 0 0") + "<link name=\"tool\"/>" + Joint("weld", "fixed", "a", "tool"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_DOUBLE_EQ(robot->links[0].mass_kg, 2);
}

TEST(JointsReaderTest, WhatIsFixedToTheWorldIsTheBase) {
  const auto [robot, messages] =
      ReadParts(Cube("tip", "0 0 0.5 0 0 0") + Cube("foot", "0 0 0.1 0 0 0") +
                Joint("turn", "continuous", "foot", "tip", kUp) + Joint("anchor", "fixed", "world", "foot"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
  EXPECT_EQ(robot->links[0].name, "foot");
  EXPECT_EQ(robot->joints[0].parent, 0);
  EXPECT_EQ(robot->joints[0].child, 1);
}

TEST(JointsReaderTest, TheFirstLinkThatIsNoChildIsTheBase) {
  const auto [robot, messages] = ReadParts(Cube("tip", "0 0 0.5 0 0 0") + Cube("foot", "0 0 0.1 0 0 0") +
                                           Joint("turn", "continuous", "foot", "tip", kUp));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_FALSE(robot->fixed_base);
  EXPECT_EQ(robot->links[0].name, "foot");
}

TEST(JointsReaderTest, AnAxisHasStopsSpringAndDamper) {
  const auto [robot, messages] = ReadParts(
      Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0 0 0.5 0 0 0") +
      Joint(
          "lift", "prismatic", "a", "b",
          kUp +
              "<limit><lower>-0.1</lower><upper>0.3</upper><effort>50</effort><velocity>0.2</velocity></"
              "limit>"
              "<dynamics><damping>3</damping><friction>2</friction><spring_reference>0.05</spring_reference>"
              "<spring_stiffness>400</spring_stiffness></dynamics>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  const JointModel& lift = robot->joints[0];
  EXPECT_EQ(lift.kind, JointModel::Kind::kSlider);
  EXPECT_EQ(lift.lower, -0.1);
  EXPECT_EQ(lift.upper, 0.3);
  EXPECT_EQ(lift.max_effort, 50);
  EXPECT_EQ(lift.max_velocity, 0.2);
  EXPECT_EQ(lift.damping, 3);
  EXPECT_EQ(lift.friction, 2);
  EXPECT_EQ(lift.stiffness, 400);
  EXPECT_EQ(lift.rest, 0.05);
}

TEST(JointsReaderTest, WithoutLimitsAnAxisHasNone) {
  const auto [robot, messages] = ReadParts(Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0 0 0.5 0 0 0") +
                                           Joint("turn", "revolute", "a", "b", kUp));
  ASSERT_NE(robot, nullptr) << messages;
  const JointModel& turn = robot->joints[0];
  for (const double none : {-turn.lower, turn.upper, turn.max_effort, turn.max_velocity}) {
    EXPECT_TRUE(std::isinf(none));
  }
}

std::string Motor(const std::string& name, const std::string& parent, const std::string& child) {
  return Joint(name, "revolute", parent, child,
               kUp + "<limit><effort>5</effort><velocity>2</velocity></limit>");
}

/// Two cubes on a third.
std::string TwoMotors() {
  return Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0 0 0.5 0 0 0") + Cube("c", "0 0 0.9 0 0 0") +
         Motor("j", "a", "b") + Motor("k", "b", "c");
}

TEST(JointsReaderTest, JointsWithMotorsAreAGroupByDefault) {
  const auto [robot, messages] = ReadParts(TwoMotors());
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].module, "joints");
  EXPECT_EQ(robot->actuators[0].joints, (std::vector<int>{0, 1}));
  EXPECT_TRUE(robot->actuators[0].is_board());
}

TEST(JointsReaderTest, AGroupHasItsJointsInItsOrderAndItsTool) {
  const auto [robot, messages] = ReadParts(
      TwoMotors() + "<coopdyn:group name=\"arm\" joints=\"k j\" profile=\"trapezoidal\" tool=\"c\" " +
      "gravity_compensation=\"true\" encoder_resolution=\"0.01\" encoder_noise_stddev=\"0.002\"/>");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].joints, (std::vector<int>{1, 0}));
  const auto& board = std::get<BoardModel>(robot->actuators[0].kind);
  EXPECT_EQ(board.profile, BoardModel::Profile::kTrapezoidal);
  EXPECT_TRUE(board.gravity_compensation);
  ASSERT_TRUE(board.tool);
  EXPECT_EQ(board.tool->link, 2);
  EXPECT_DOUBLE_EQ(board.tool->X_RF.p.z(), 0.9);
  EXPECT_EQ(board.encoder_resolution, 0.01);
  EXPECT_EQ(board.encoder_noise_stddev, 0.002);
}

TEST(JointsReaderTest, MistakesInGroupsSayWhatToWrite) {
  const auto said = [](const std::string& group) {
    return ReadParts(TwoMotors() + "<coopdyn:group " + group + "/>").messages;
  };
  EXPECT_THAT(said("joints=\"j\""), HasSubstr("the attribute 'name' is missing"));
  EXPECT_THAT(said("name=\"arm\""), HasSubstr("the attribute 'joints' is missing"));
  EXPECT_THAT(said("name=\"arm\" joints=\"j l\""), HasSubstr("there is no joint 'l'"));
  EXPECT_THAT(said("name=\"arm\" joints=\"j j\""), HasSubstr("named twice"));
  EXPECT_THAT(said("name=\"Arm\" joints=\"j\""), HasSubstr("a-z, 0-9 and _"));
  EXPECT_THAT(said("name=\"arm\" joints=\"j\" profile=\"soft\""), HasSubstr("minimum_jerk or trapezoidal"));
  EXPECT_THAT(said("name=\"arm\" joints=\"j\" tool=\"hand\""), HasSubstr("there is no link 'hand'"));
  EXPECT_THAT(said("name=\"arm\" joints=\"j\"/><coopdyn:group name=\"leg\" joints=\"j\""),
              HasSubstr("belongs to another group"));
}

TEST(JointsReaderTest, AModuleOfJointsIsWrittenAsAGroup) {
  EXPECT_THAT(ReadParts(TwoMotors() + "<coopdyn:module type=\"joints\"/>").messages,
              HasSubstr("<coopdyn:group name=\"arm\""));
}

TEST(JointsReaderTest, MistakesAreNamedWithTheirLine) {
  const std::string links = Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0 0 0.5 0 0 0");
  const auto said = [&](const std::string& joints) { return ReadParts(links + joints).messages; };
  EXPECT_THAT(said(Joint("j", "revolute2", "a", "b", kUp)),
              HasSubstr("rig/model.sdf:4: error: joint 'j' must be of type"));
  EXPECT_THAT(said(Joint("j", "revolute", "world", "b", kUp)),
              HasSubstr("link 'a' hangs on no joint that leads to link 'world'"));
  EXPECT_THAT(said(Joint("j", "fixed", "a", "b") + Joint("k", "fixed", "b", "a")),
              HasSubstr("a loop of fixed joints"));
  EXPECT_THAT(said(Joint("j", "fixed", "world", "a") + Joint("k", "fixed", "world", "b")),
              HasSubstr("link 'a' and link 'b' are both fixed to the world"));
  EXPECT_THAT(said(Joint("j", "fixed", "a", "b") + Joint("k", "revolute", "a", "b", kUp)),
              HasSubstr("5: error: joint 'k' joins links that fixed joints hold together"));
  EXPECT_THAT(said(""), HasSubstr("3: error: link 'b' hangs on no joint that leads to link 'a'"));
  const auto limited = [&](const std::string& lower, const std::string& upper) {
    return said(Joint("j", "revolute", "a", "b",
                      kUp + "<limit><lower>" + lower + "</lower><upper>" + upper + "</upper></limit>"));
  };
  EXPECT_THAT(limited("1", "-1"), HasSubstr("must not lie above <upper>"));
  EXPECT_THAT(limited("0.5", "1"), HasSubstr("4: warning: joint 'j' starts at 0.5, its nearest limit"));
  EXPECT_THAT(limited("-4", "1"), HasSubstr("beyond 180 degrees"));
  EXPECT_THAT(said(Joint("j", "revolute", "a", "b", kUp + "<dynamics><damping>-1</damping></dynamics>")),
              HasSubstr("<damping> of joint 'j' must be a number from 0"));
}

TEST(JointsReaderTest, AnArmatureIsANumberOfAtLeastZero) {
  const auto with = [](const std::string& armature) {
    return ReadParts(Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0.3 0 0.1 0 0 0") +
                     "<joint name='j' type='revolute' coopdyn:armature='" + armature +
                     "'><parent>a</parent><child>b</child><axis>" + kUp + "</axis></joint>");
  };
  const auto [robot, messages] = with("0.03");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].armature, 0.03);
  for (const char* wrong : {"-1", "heavy", "nan", "1e7"})
    EXPECT_THAT(with(wrong).messages, HasSubstr("coopdyn:armature of joint 'j' is the inertia")) << wrong;
}

TEST(JointsReaderTest, LimitsWithoutZeroMakeAJointStartAtTheNearest) {
  const auto [robot, messages] =
      ReadParts(Cube("a", "0 0 0.1 0 0 0") + Cube("b", "0.3 0 0.1 0 0 0") + Cube("c", "0.6 0 0.1 0 0 0") +
                Joint("j", "revolute", "a", "b",
                      kUp + "<limit><lower>0.5</lower><upper>1</upper><effort>1</effort></limit>") +
                Joint("k", "prismatic", "b", "c",
                      "<xyz>1 0 0</xyz><limit><lower>-0.3</lower><upper>-0.2</upper></limit>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].start, 0.5);
  EXPECT_EQ(robot->joints[0].lower, 0.5);
  EXPECT_EQ(robot->joints[1].start, -0.2);
  // SDF's joint frame is that of the child: b turns in place, and c moves with it and 0.2 m back.
  const Vector3 ahead(std::cos(0.5), std::sin(0.5), 0);
  EXPECT_NEAR((robot->links[1].X_RL.p - Vector3(0.3, 0, 0.1)).norm(), 0, 1e-12);
  EXPECT_NEAR((robot->links[2].X_RL.p - Vector3(0.3, 0, 0.1) - 0.1 * ahead).norm(), 0, 1e-12);
  EXPECT_NEAR((robot->joints[1].axis_R - ahead).norm(), 0, 1e-12);
  const RobotModel zero = AtZero(*robot);
  EXPECT_NEAR((zero.links[2].X_RL.p - Vector3(0.6, 0, 0.1)).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace coopdyn
