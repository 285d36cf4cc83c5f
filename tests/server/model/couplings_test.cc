// SPDX-License-Identifier: MIT
// Joints that follow others, and screws.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>

#include "server/model/model_source.h"
#include "server/model/readers.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

struct CoupledAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

CoupledAnswer ReadCoupled(const std::string& file, const std::string& text) {
  Diagnostics diagnostics;
  CoupledAnswer answer;
  answer.robot = ReadRobotModelText(text, file, "rig", diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}

std::string RodOf(const std::string& name) {
  return "<link name=\"" + name +
         "\"><pose>0 0 0.1 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>"
         "<izz>0.01</izz></inertia></inertial><collision name=\"c\"><geometry><sphere><radius>0.1</radius>"
         "</sphere></geometry></collision></link>\n";
}

/// A revolute joint with `inside` in its axis.
std::string TurnOf(const std::string& name, const std::string& parent, const std::string& child,
                   const std::string& inside = "", const std::string& xyz = "0 0 1") {
  return "<joint name=\"" + name + "\" type=\"revolute\"><parent>" + parent + "</parent><child>" + child +
         "</child><axis><xyz>" + xyz + "</xyz>" + inside +
         "<limit><effort>5</effort><velocity>2</velocity></limit></axis></joint>\n";
}

/// Lines 2 to 5: a base with three rods.
std::string Rods() {
  return RodOf("base") + RodOf("a") + RodOf("b") + RodOf("c");
}

CoupledAnswer ReadRods(const std::string& inside, const std::string& version = "1.11") {
  return ReadCoupled("rig/model.sdf",
                     "<sdf version=\"" + version +
                         "\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">\n" + Rods() +
                         inside + "<coopdyn:module type=\"pose\"/></model></sdf>");
}

std::string MimicOf(const std::string& leader, const std::string& inside = "") {
  return "<mimic joint=\"" + leader + "\">" + inside + "</mimic>";
}

TEST(CouplingsTest, AMimicOfSdfFollowsItsLeader) {
  const auto [robot, messages] = ReadRods(
      TurnOf("j", "base", "a") +
      TurnOf("k", "base", "b",
             MimicOf("j", "<multiplier>2</multiplier><offset>0.5</offset><reference>0.1</reference>")) +
      TurnOf("l", "base", "c"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  ASSERT_EQ(robot->couplings.size(), 1u);
  EXPECT_EQ(robot->couplings[0].follower, 1);
  EXPECT_EQ(robot->couplings[0].leader, 0);
  EXPECT_DOUBLE_EQ(robot->couplings[0].multiplier, 2);
  EXPECT_DOUBLE_EQ(robot->couplings[0].offset, 0.3);
}

TEST(CouplingsTest, AMimicOfUrdfFollowsItsLeader) {
  const std::string inertia =
      "<inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial></link>\n";
  const auto [robot, messages] = ReadCoupled(
      "rig.urdf",
      "<robot name=\"rig\">\n<link name=\"base\">" + inertia + "<link name=\"a\">" + inertia +
          "<link name=\"b\">" + inertia +
          "<joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"a\"/></joint>\n"
          "<joint name=\"k\" type=\"continuous\"><parent link=\"base\"/><child link=\"b\"/>"
          "<mimic joint=\"j\" multiplier=\"-3\" offset=\"0.25\"/></joint>\n</robot>");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->couplings.size(), 1u);
  EXPECT_EQ(robot->joints[static_cast<std::size_t>(robot->couplings[0].follower)].name, "k");
  EXPECT_DOUBLE_EQ(robot->couplings[0].multiplier, -3);
  EXPECT_DOUBLE_EQ(robot->couplings[0].offset, 0.25);
}

TEST(CouplingsTest, AChainOfFollowersFollowsItsFirst) {
  const std::string twice = "<multiplier>2</multiplier><offset>1</offset>";
  const auto [robot, messages] =
      ReadRods(TurnOf("l", "b", "c", MimicOf("k", twice)) + TurnOf("k", "a", "b", MimicOf("j", twice)) +
               TurnOf("j", "base", "a"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->couplings.size(), 2u);
  const CouplingModel* last = robot->FindCoupling(0);
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->leader, 2);
  EXPECT_DOUBLE_EQ(last->multiplier, 4);
  EXPECT_DOUBLE_EQ(last->offset, 3);  // 2 · (2 q + 1) + 1
}

TEST(CouplingsTest, TheTextOfARecordingGivesTheSameCouplings) {
  const auto [robot, messages] = ReadRods(
      TurnOf("j", "base", "a") + TurnOf("k", "base", "b", MimicOf("j", "<multiplier>2</multiplier>")) +
      TurnOf("l", "base", "c"));
  ASSERT_NE(robot, nullptr) << messages;
  const auto again = ReadCoupled("rig/model.sdf", robot->text);
  ASSERT_NE(again.robot, nullptr) << again.messages;
  ASSERT_EQ(again.robot->couplings.size(), 1u);
  EXPECT_DOUBLE_EQ(again.robot->couplings[0].multiplier, 2);
}

// Each joint checks only those that it may fix: checking all for each would take minutes.
TEST(CouplingsTest, AVeryLongChainThatFollowsAFixedJointIsFixed) {
  constexpr int kCount = 30'000;
  XmlNode model;
  model.name = "model";
  for (int i = kCount; i >= 0; --i) {
    XmlNode& joint = model.Add("joint");
    joint.Set("name", "j" + std::to_string(i));
    joint.Set("type", i == 0 ? "fixed" : "revolute");
    if (i > 0) joint.Add("axis").Add("mimic").Set("joint", "j" + std::to_string(i - 1));
  }
  Diagnostics diagnostics;
  GatherMimics(model, true, diagnostics);
  EXPECT_EQ(model.children.size(), static_cast<std::size_t>(kCount + 1));
  for (const XmlNode& joint : model.children) ASSERT_EQ(joint.Attribute("type"), "fixed");
}

TEST(CouplingsTest, AFollowerIsInNoGroup) {
  const std::string joints =
      TurnOf("j", "base", "a") + TurnOf("k", "base", "b", MimicOf("j")) + TurnOf("l", "base", "c");
  const auto [robot, messages] = ReadRods(joints);
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].joints, (std::vector<int>{0, 2}));
  EXPECT_THAT(ReadRods(joints + "<coopdyn:group name=\"arm\" joints=\"j k\"/>").messages,
              HasSubstr("rig/model.sdf:9: error: <coopdyn:group>: the joint 'k' follows 'j' (<mimic> or "
                        "gearbox) and has no motor: leave it out"));
}

TEST(CouplingsTest, MistakesInMimicsSayLineAndWhatToDo) {
  const auto said = [](const std::string& mimic, const std::string& last) {
    return ReadRods(TurnOf("j", "base", "a") + TurnOf("k", "base", "b", mimic) + last).messages;
  };
  const std::string last = TurnOf("l", "base", "c");
  EXPECT_THAT(said(MimicOf("i"), last),
              HasSubstr("rig/model.sdf:7: error: <mimic> of joint 'k' names no joint of this robot: 'i'; did "
                        "you mean"));
  EXPECT_THAT(said(MimicOf(""), last), HasSubstr("7: error: <mimic> of joint 'k' names no joint"));
  EXPECT_THAT(said(MimicOf("k"), last),
              HasSubstr("7: error: <mimic> of joint 'k' names the joint itself: name the one that leads"));
  EXPECT_THAT(said(MimicOf("j") + MimicOf("j"), last), HasSubstr("7: error: joint 'k' follows two joints"));
  EXPECT_THAT(said(MimicOf("l"), TurnOf("l", "base", "c", MimicOf("k"))),
              HasSubstr("in a loop: remove one <mimic>"));
  EXPECT_THAT(said("<mimic joint=\"j\" axis=\"axis2\"/>", last), HasSubstr("write two joints"));
  EXPECT_THAT(said(MimicOf("j", "<multiplier>nan</multiplier>"), last),
              HasSubstr("7: error: the multiplier in <mimic> of joint 'k' must be a number"));
  EXPECT_THAT(
      said(MimicOf("l"), "<joint name=\"l\" type=\"fixed\"><parent>a</parent><child>c</child></joint>"),
      HasSubstr("7: error: <mimic> of joint 'k' names the fixed joint 'l', which cannot move"));
  EXPECT_THAT(
      said(MimicOf("l"), "<joint name=\"l\" type=\"ball\"><parent>a</parent><child>c</child></joint>"),
      HasSubstr("'l' turns about more: name a revolute"));
}

std::string GearboxOf(const std::string& inside, const std::string& axis = "0 0 1",
                      const std::string& axis2 = "0 0 1") {
  return "<joint name=\"gear\" type=\"gearbox\"><parent>a</parent><child>b</child>" + inside + "<axis><xyz>" +
         axis + "</xyz></axis><axis2><xyz>" + axis2 + "</xyz></axis2></joint>\n";
}
const std::string kThreeToOne =
    "<gearbox_ratio>3</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body>";

TEST(CouplingsTest, AGearboxTurnsItsChildTheOtherWay) {
  const auto [robot, messages] = ReadRods(
      TurnOf("j", "base", "a") + TurnOf("k", "base", "b") + GearboxOf(kThreeToOne) + TurnOf("l", "b", "c"),
      "1.9");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 3u);
  ASSERT_EQ(robot->couplings.size(), 1u);
  EXPECT_EQ(robot->couplings[0].follower, 1);
  EXPECT_EQ(robot->couplings[0].leader, 0);
  EXPECT_DOUBLE_EQ(robot->couplings[0].multiplier, -3);
}

TEST(CouplingsTest, TheSignsOfAGearboxAreThoseOfItsJointsAxesAndOrder) {
  // k turns about -z, and j joins the base to a in the opposite direction.
  const auto [robot, messages] =
      ReadRods(TurnOf("j", "a", "base") + TurnOf("k", "base", "b", "", "0 0 -1") +
                   GearboxOf(kThreeToOne, "0 0 1", "0 0 1") + TurnOf("l", "b", "c"),
               "1.9");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->couplings.size(), 1u);
  EXPECT_DOUBLE_EQ(robot->couplings[0].multiplier, -3);
  const auto turned = ReadRods(TurnOf("j", "base", "a") + TurnOf("k", "base", "b") +
                                   GearboxOf(kThreeToOne, "0 0 1", "0 0 -1") + TurnOf("l", "b", "c"),
                               "1.9");
  ASSERT_NE(turned.robot, nullptr) << turned.messages;
  EXPECT_DOUBLE_EQ(turned.robot->couplings[0].multiplier, 3);
}

TEST(CouplingsTest, MistakesInGearboxesSayLineAndWhatToDo) {
  const auto said = [](const std::string& gearbox) {
    return ReadRods(TurnOf("j", "base", "a") + TurnOf("k", "base", "b") + TurnOf("l", "base", "c") + gearbox,
                    "1.9")
        .messages;
  };
  EXPECT_THAT(said(GearboxOf("")),
              HasSubstr("rig/model.sdf:9: error: gearbox 'gear' needs <gearbox_reference_body>"));
  EXPECT_THAT(said(GearboxOf("<gearbox_reference_body>c</gearbox_reference_body>")),
              HasSubstr("needs a revolute joint between its reference body 'c' and 'a'"));
  EXPECT_THAT(said(GearboxOf(kThreeToOne, "0 1 0")), HasSubstr("that of 'j' does not"));
  EXPECT_THAT(said(GearboxOf("<gearbox_ratio>0</gearbox_ratio>")),
              HasSubstr("<gearbox_ratio> of 'gear' must be a number, not 0"));
}

std::string ScrewOf(const std::string& inside) {
  return "<joint name=\"s\" type=\"screw\"><parent>base</parent><child>a</child>" + inside +
         "<axis><xyz>0 0 1</xyz></axis></joint>\n" + TurnOf("k", "base", "b") + TurnOf("l", "base", "c");
}

TEST(ScrewTest, ItsPitchIsThatOfARevolution) {
  const auto [robot, messages] = ReadRods(ScrewOf("<screw_thread_pitch>0.02</screw_thread_pitch>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].kind, JointModel::Kind::kScrew);
  EXPECT_TRUE(robot->joints[0].has_axis());
  EXPECT_NEAR(robot->joints[0].pitch_m_rad, 0.02 / (2 * std::numbers::pi), 1e-12);
}

TEST(ScrewTest, TheOlderPitchIsInRadiansPerMetreOfALeftHandedThread) {
  const auto [robot, messages] = ReadRods(ScrewOf("<thread_pitch>-100</thread_pitch>"), "1.9");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_DOUBLE_EQ(robot->joints[0].pitch_m_rad, 0.01);
}

TEST(ScrewTest, WithoutAPitchItIsAnError) {
  for (const char* pitch : {"", "<screw_thread_pitch>0</screw_thread_pitch>"}) {
    EXPECT_THAT(ReadRods(ScrewOf(pitch)).messages,
                HasSubstr("rig/model.sdf:6: error: joint 's' needs <screw_thread_pitch>"));
  }
  EXPECT_THAT(ReadRods(ScrewOf("<screw_thread_pitch>x</screw_thread_pitch>")).messages,
              HasSubstr("6: error: <thread_pitch> needs finite numbers, not 'x'"));
}

}  // namespace
}  // namespace coopdyn
