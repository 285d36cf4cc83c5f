// SPDX-License-Identifier: MIT
// <include merge="true">: the parts of a model become parts of another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/model/sdf_world.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

struct MergeAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};
/// A model that includes another with these attributes and elements.
MergeAnswer ReadMerged(const std::string& attributes, const std::string& inside) {
  const TempFolder folder;
  folder.Write("part/model.sdf",
               "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"part\"><link "
               "name=\"body\"><pose>0 0 0.5 0 0 "
               "0</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>"
               "<izz>0.01</izz></inertia></inertial><collision "
               "name=\"c\"><geometry><sphere><radius>0.1</radius></sphere>"
               "</geometry></collision></link><coopdyn:module type=\"compass\"/></model></sdf>");
  const auto file =
      folder.Write("whole/model.sdf",
                   "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"whole\">\n"
                   "<include " +
                       attributes + "><uri>model://part</uri>" + inside +
                       "</include><coopdyn:module type=\"pose\"/></model></sdf>");
  Diagnostics diagnostics;
  MergeAnswer answer;
  answer.robot = ReadRobotModel(file, SearchPath{{folder.path()}}, diagnostics);
  answer.messages = folder.Strip(diagnostics.ToString());
  return answer;
}

TEST(IncludeMergeTest, LinksKeepTheirNamesAndOurElementsCount) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.messages, "");
  EXPECT_EQ(answer.robot->links.at(0).name, "body");
  EXPECT_NE(answer.robot->Find<CompassModel>(), nullptr);
  EXPECT_NE(answer.robot->Find<PoseModel>(), nullptr);
}

TEST(IncludeMergeTest, WithoutItTheyAreAModelInside) {
  const MergeAnswer answer = ReadMerged("", "");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.robot->links.at(0).name, "part::body");
}

TEST(IncludeMergeTest, APoseMovesThePartsThatMerge) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "<pose>0.3 0 1 0 0 1.5707963267948966</pose>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.messages, "");
  const LinkModel& link = answer.robot->links.at(0);
  EXPECT_EQ(link.name, "body");
  EXPECT_NEAR((link.X_RL.p - Vector3(0.3, 0, 1.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((link.X_RL.q * Vector3::UnitX() - Vector3::UnitY()).norm(), 0, 1e-12);
}

TEST(IncludeMergeTest, AJointThatNamesALinkOfTheOuterModelIsAJointOfThat) {
  const std::string inertial =
      "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>";
  const TempFolder folder;
  folder.Write(
      "leg/model.sdf",
      "<sdf version=\"1.6\"><model name=\"leg\"><link name=\"hip\"><pose>0 0 0.5 0 0 0</pose>" + inertial +
          "</link>\n<joint name=\"pitch\" type=\"revolute\"><parent>root</parent><child>hip</child><axis>"
          "<xyz>0 1 0</xyz><use_parent_model_frame>1</use_parent_model_frame></axis></joint></model></sdf>");
  const auto file = folder.Write(
      "whole/model.sdf", "<sdf version=\"1.6\"><model name=\"whole\"><link name=\"root\">" + inertial +
                             "</link><include><uri>model://leg</uri><pose>0 0 1 0 0 1.5707963267948966"
                             "</pose></include></model></sdf>");
  Diagnostics diagnostics;
  const auto robot = ReadRobotModel(file, SearchPath{{folder.path()}}, diagnostics);
  ASSERT_NE(robot, nullptr) << diagnostics.ToString();
  EXPECT_THAT(
      folder.Strip(diagnostics.ToString()),
      HasSubstr("leg/model.sdf:2: warning: joint 'pitch' of model 'leg' names a link of the model around "
                "it: it is a joint of that one"));
  ASSERT_EQ(robot->joints.size(), 1u);
  const JointModel& joint = robot->joints[0];
  EXPECT_EQ(robot->links[static_cast<std::size_t>(joint.child)].name, "leg::hip");
  EXPECT_NEAR((joint.p_RJ - Vector3(0, 0, 1.5)).norm(), 0, 1e-9);
  EXPECT_NEAR((joint.axis_R + Vector3::UnitX()).norm(), 0, 1e-9);
}

TEST(IncludeMergeTest, JointsOfTheOuterModelOfOneNameAreTold) {
  const std::string inertial =
      "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>";
  const TempFolder folder;
  folder.Write(
      "leg/model.sdf",
      "<sdf version=\"1.6\"><model name=\"leg\"><frame name=\"top\"><pose>0 0 0.5 0 0 0</pose></frame>"
      "<link name=\"hip\">" +
          inertial +
          "</link>\n<joint name=\"pitch\" type=\"revolute\"><pose relative_to=\"top\"/><parent>root"
          "</parent><child>hip</child><axis><xyz expressed_in=\"top\">0 1 0</xyz></axis></joint>"
          "</model></sdf>");
  const auto leg = [](const std::string& name, const std::string& y) {
    return "<include><uri>model://leg</uri><name>" + name + "</name><pose>0 " + y +
           " 1 0 0 0</pose></include>";
  };
  const auto file = folder.Write(
      "whole/model.sdf", "<sdf version=\"1.6\"><model name=\"whole\"><link name=\"root\">" + inertial +
                             "</link>" + leg("left", "1") + leg("right", "-1") + "</model></sdf>");
  Diagnostics diagnostics;
  const auto robot = ReadRobotModel(file, SearchPath{{folder.path()}}, diagnostics);
  ASSERT_NE(robot, nullptr) << diagnostics.ToString();
  ASSERT_EQ(robot->joints.size(), 2u);
  EXPECT_EQ(robot->joints[0].name, "pitch");
  EXPECT_EQ(robot->joints[1].name, "right_pitch");
  EXPECT_NEAR((robot->joints[1].p_RJ - Vector3(0, -1, 1.5)).norm(), 0, 1e-9);
}

TEST(IncludeMergeTest, WhatIsStaticIsNotMergedAndThatIsSaid) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "<static>true</static>");
  EXPECT_THAT(answer.messages, HasSubstr("model.sdf:2: warning: merge of an <include> with <static> is "
                                         "not used"));
}

TEST(IncludeMergeTest, APlacementFrameIsPlacedByThePose) {
  for (const char* merge : {"merge=\"true\"", ""}) {
    const MergeAnswer answer = ReadMerged(
        merge, "<placement_frame>body</placement_frame><pose>0.3 0 1 0 0 1.5707963267948966</pose>");
    ASSERT_NE(answer.robot, nullptr) << answer.messages;
    EXPECT_EQ(answer.messages, "");
    const LinkModel& link = answer.robot->links.at(0);
    EXPECT_NEAR((link.X_RL.p - Vector3(0.3, 0, 1)).norm(), 0, 1e-11);
    EXPECT_NEAR((link.X_RL.q * Vector3::UnitX() - Vector3::UnitY()).norm(), 0, 1e-11);
  }
}

TEST(IncludeMergeTest, AxesAndFramesOfTheModelTurnWithIt) {
  const TempFolder folder;
  const std::string body =
      "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>";
  folder.Write("part/model.sdf",
               "<sdf version=\"1.9\"><model name=\"part\"><pose>0 0 2 0 0 1.5707963267948966</pose>"
               "<frame name=\"f\"><pose>1 0 0 0 0 0</pose></frame><link name=\"a\">" +
                   body + "</link><link name=\"b\"><pose relative_to=\"f\">0 0 0 0 0 0</pose>" + body +
                   "</link><joint name=\"j\" type=\"revolute\"><parent>a</parent><child>b</child><axis><xyz "
                   "expressed_in=\"__model__\">1 0 0</xyz></axis></joint></model></sdf>");
  const auto file = folder.Write("whole/model.sdf",
                                 "<sdf version=\"1.9\"><model name=\"whole\"><include merge=\"true\">"
                                 "<uri>model://part</uri></include></model></sdf>");
  Diagnostics diagnostics;
  const auto robot = ReadRobotModel(file, SearchPath{{folder.path()}}, diagnostics);
  ASSERT_NE(robot, nullptr) << diagnostics.ToString();
  ASSERT_EQ(robot->links.size(), 2u);
  EXPECT_NEAR((robot->links[1].X_RL.p - robot->links[0].X_RL.p - Vector3(0, 1, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((robot->joints.at(0).axis_R - Vector3::UnitY()).norm(), 0, 1e-12);
}

TEST(IncludeMergeTest, ARecordingsTextNeedsNoFiles) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "");
  ASSERT_NE(answer.robot, nullptr);
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(answer.robot->text, "whole.sdf", "whole", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(again->modules().size(), answer.robot->modules().size());
}

/// A world of `count` includes of part.sdf, whose text is `part`.
std::string ReadIncludes(int count, const std::string& part) {
  const TempFolder folder;
  folder.Write("part.sdf", part);
  std::string world = "<sdf version=\"1.9\"><world name=\"w\">";
  for (int i = 0; i < count; ++i) world += "<include><uri>part.sdf</uri></include>\n";
  const auto file = folder.Write("world.sdf", world + "</world></sdf>");
  Diagnostics diagnostics;
  ReadSdfWorld(file, SearchPath(), diagnostics);
  return folder.Strip(diagnostics.ToString());
}

/// A model of 300 links, each with `inside`.
std::string ManyLinks(const std::string& inside) {
  std::string part = "<sdf version=\"1.9\"><model name=\"p\">";
  for (int i = 0; i < 300; ++i) part += "<link name=\"l" + std::to_string(i) + "\">" + inside + "</link>";
  return part + "</model></sdf>";
}

TEST(IncludeTest, AFileThatIsIncludedOftenIsReadOnce) {
  const std::string messages = ReadIncludes(3, "<sdf version=\"1.9\"><model");
  const std::size_t first = messages.find("not well-formed");
  ASSERT_NE(first, std::string::npos) << messages;
  EXPECT_EQ(messages.find("not well-formed", first + 1), std::string::npos) << messages;
}

TEST(IncludeTest, AWorldHasALimitOfModels) {
  EXPECT_THAT(
      ReadIncludes(11, ManyLinks("")),
      HasSubstr("part.sdf:1: error: a world has at most 3000 models, and a model of loose links counts "
                "as one for each: leave some out, or write a scenario with [SWARM]\n"));
}

TEST(IncludeTest, IncludesHaveALimitTogether) {
  EXPECT_THAT(
      ReadIncludes(900, ManyLinks("<pose/>")),
      HasSubstr("world.sdf:167: error: what this file includes has more than 100000 elements together: "
                "include fewer models, or simpler ones\n"));
}

}  // namespace
}  // namespace coopdyn
