// SPDX-License-Identifier: MIT
// Joints of several axes in a model's file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "server/model/readers.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct SixRig {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;

  std::vector<std::string> joints() const {
    std::vector<std::string> names;
    for (const JointModel& joint : robot->joints) names.push_back(joint.name);
    return names;
  }
  const JointModel& joint(const std::string& name) const {
    return *std::ranges::find(robot->joints, name, &JointModel::name);
  }
};

SixRig ReadSixRig(const std::string& parts) {
  const auto link = [](const std::string& name, const std::string& pose) {
    return "<link name=\"" + name + "\"><pose>" + pose +
           "</pose><inertial><mass>2</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></"
           "inertial><collision name=\"c\"><geometry><sphere><radius>0.05</radius></sphere></geometry></"
           "collision></link>\n";
  };
  Diagnostics diagnostics;
  SixRig rig;
  rig.robot = ReadRobotModelText(
      "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">\n" +
          link("a", "0 0 1 0 0 0") + link("b", "0 0.5 1 0 0 1.5707963267948966") + parts +
          "<coopdyn:module type=\"pose\"/></model></sdf>",
      "rig/model.sdf", "rig", diagnostics);
  rig.messages = diagnostics.ToString();
  return rig;
}

std::string SixAxes(const std::string& axes, const std::string& words = "") {
  return "<coopdyn:six_axis name=\"six\" parent=\"a\" child=\"b\" " + words + ">" + axes +
         "</coopdyn:six_axis>\n";
}

TEST(SixAxisModelTest, ItsAxesAreJointsInTheOrderOfTheFile) {
  const SixRig rig = ReadSixRig(SixAxes(
      "<coopdyn:axis name=\"z\" stiffness=\"50\" damping=\"2\" rest=\"0.1\" lower=\"-0.2\" upper=\"0.3\"/>"
      "<coopdyn:axis name=\"rx\" max_effort=\"5\" max_velocity=\"2\"/>"
      "<coopdyn:axis name=\"ry\" xyz=\"0 3 0\"/>"));
  ASSERT_NE(rig.robot, nullptr) << rig.messages;
  EXPECT_THAT(rig.joints(), ElementsAre("six.z", "six.rx", "six.ry"));
  const JointModel& z = rig.joint("six.z");
  EXPECT_TRUE(z.slides());
  EXPECT_EQ(z.stiffness, 50);
  EXPECT_EQ(z.damping, 2);
  EXPECT_EQ(z.rest, 0.1);
  EXPECT_EQ(z.lower, -0.2);
  EXPECT_EQ(z.upper, 0.3);
  // The axes are those of the child, unless the joint says otherwise.
  EXPECT_NEAR((rig.joint("six.rx").axis_R - Vector3::UnitY()).norm(), 0, 1e-9);
  EXPECT_NEAR((rig.joint("six.ry").axis_R + Vector3::UnitX()).norm(), 0, 1e-9);
  EXPECT_NEAR((z.p_RJ - Vector3(0, 0.5, 1)).norm(), 0, 1e-9);
  ASSERT_EQ(rig.robot->actuators.size(), 1u);
  EXPECT_THAT(rig.robot->actuators[0].joints, ElementsAre(1)) << "what has a motor is in the group `joints`";
  EXPECT_EQ(rig.robot->links.back().name, "b") << "the last link stays the last";
}

TEST(SixAxisModelTest, ItStandsWhereItsPoseSays) {
  const SixRig rig = ReadSixRig(SixAxes("<coopdyn:axis name=\"rz\"/>",
                                        "pose=\"0 0.2 1 1.5707963267948966 0 0\" relative_to=\"__model__\""));
  ASSERT_NE(rig.robot, nullptr) << rig.messages;
  EXPECT_NEAR((rig.joint("six.rz").p_RJ - Vector3(0, 0.2, 1)).norm(), 0, 1e-9);
  EXPECT_NEAR((rig.joint("six.rz").axis_R + Vector3::UnitY()).norm(), 0, 1e-9);
}

TEST(SixAxisModelTest, ThreeFreeTurnsAreABallAndNoAxisIsFixed) {
  const SixRig ball =
      ReadSixRig(SixAxes("<coopdyn:axis name=\"x\"/><coopdyn:axis name=\"rx\"/><coopdyn:axis "
                         "name=\"ry\"/><coopdyn:axis name=\"rz\"/>"));
  ASSERT_NE(ball.robot, nullptr) << ball.messages;
  EXPECT_THAT(ball.joints(), ElementsAre("six.x", "six.r"));
  EXPECT_EQ(ball.joint("six.r").kind, JointModel::Kind::kBall);
  const SixRig none = ReadSixRig(SixAxes(""));
  ASSERT_NE(none.robot, nullptr) << none.messages;
  EXPECT_EQ(none.robot->links.size(), 1u);
}

TEST(SixAxisModelTest, ItsTextGivesTheSameModelAgain) {
  const SixRig rig =
      ReadSixRig(SixAxes("<coopdyn:axis name=\"x\"/><coopdyn:axis name=\"ry\" stiffness=\"3\"/>"));
  ASSERT_NE(rig.robot, nullptr) << rig.messages;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(rig.robot->text, "rig/model.sdf", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(again->text, rig.robot->text);
  EXPECT_TRUE(again->links[1].is_carrier);
  EXPECT_EQ(again->links[1].mass_kg, rig.robot->links[1].mass_kg);
}

TEST(SixAxisModelTest, Revolute2IsTwoHingesAndASuspension) {
  const std::string axes =
      "<parent>a</parent><child>b</child><axis><xyz expressed_in=\"__model__\">0 0 "
      "1</xyz><limit><lower>-0.5</lower>"
      "<upper>0.5</upper></limit></axis><axis2><xyz expressed_in=\"__model__\">0 1 "
      "0</xyz><limit><effort>3</effort>"
      "<velocity>9</velocity></limit></axis2>";
  const SixRig rig = ReadSixRig("<joint name=\"wheel\" type=\"revolute2\">" + axes +
                                "<coopdyn:suspension stiffness=\"900\" damping=\"40\"/></joint>");
  ASSERT_NE(rig.robot, nullptr) << rig.messages;
  EXPECT_THAT(rig.joints(), ElementsAre("wheel.suspension", "wheel.axis1", "wheel.axis2"));
  const JointModel& suspension = rig.joint("wheel.suspension");
  EXPECT_TRUE(suspension.slides());
  EXPECT_EQ(suspension.stiffness, 900);
  EXPECT_NEAR((suspension.axis_R - Vector3::UnitZ()).norm(), 0, 1e-9);
  EXPECT_EQ(rig.joint("wheel.axis1").upper, 0.5);
  EXPECT_NEAR((rig.joint("wheel.axis2").axis_R - Vector3::UnitY()).norm(), 0, 1e-9);
  const SixRig plain = ReadSixRig("<joint name=\"wheel\" type=\"revolute2\">" + axes + "</joint>");
  ASSERT_NE(plain.robot, nullptr) << plain.messages;
  EXPECT_THAT(plain.joints(), ElementsAre("wheel.axis1", "wheel.axis2"));
}

TEST(SixAxisModelTest, MistakesAreNamedWithTheirLine) {
  const auto said = [](const std::string& axes, const std::string& words = "") {
    return ReadSixRig(SixAxes(axes, words)).messages;
  };
  EXPECT_THAT(said("<coopdyn:axis name=\"w\"/>"),
              HasSubstr("rig/model.sdf:4: error: <coopdyn:axis>: name is x, y, z"));
  EXPECT_THAT(said("<coopdyn:axis name=\"x\"/><coopdyn:axis name=\"x\"/>"), HasSubstr("two axes 'x'"));
  EXPECT_THAT(said("<coopdyn:axis name=\"x\" stifness=\"1\"/>"), HasSubstr("did you mean 'stiffness'"));
  EXPECT_THAT(said("<coopdyn:axis name=\"x\" lower=\"low\"/>"), HasSubstr("'lower' must be a finite number"));
  EXPECT_THAT(said("<coopdyn:axis name=\"x\" max_effort=\"1\"/>"),
              HasSubstr("both max_effort and max_velocity"));
  EXPECT_THAT(said("<coopdyn:drive/>"), HasSubstr("unknown element <coopdyn:drive> in <coopdyn:six_axis>"));
  EXPECT_THAT(said("", "axis=\"1\""), HasSubstr("unknown attribute 'axis'"));
  EXPECT_THAT(
      said(
          "<coopdyn:axis name=\"rx\"/><coopdyn:axis name=\"ry\"/><coopdyn:axis name=\"rz\" friction=\"1\"/>"),
      HasSubstr("'six.ry' is the second of three turns"));
  EXPECT_THAT(ReadSixRig("<coopdyn:six_axis name=\"six\" parent=\"a\" child=\"c\"/>").messages,
              HasSubstr("child=\"c\" of 'six' names no link of this model"));
  EXPECT_THAT(ReadSixRig("<coopdyn:six_axis name=\"six\" child=\"b\"/>").messages,
              HasSubstr("the attribute 'parent' is missing"));
}

}  // namespace
}  // namespace coopdyn
