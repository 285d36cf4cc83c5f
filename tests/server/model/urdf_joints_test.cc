// SPDX-License-Identifier: MIT
// Joints of URDF that SDF lacks, and the modules that command them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

std::string Body(const std::string& name) {
  return "<link name=\"" + name +
         "\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" "
         "ixz=\"0\" iyz=\"0\"/></inertial><collision><geometry><box size=\"0.2 0.2 "
         "0.2\"/></geometry></collision></link>\n";
}
std::string JointOf(const std::string& type, const std::string& parent, const std::string& child,
                    const std::string& inside = {}) {
  return "<joint name=\"" + child + "_j\" type=\"" + type + "\"><origin xyz=\"0 0 1\"/><parent link=\"" +
         parent + "\"/><child link=\"" + child + "\"/>" + inside + "</joint>\n";
}
const std::string kLimit = "<limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"3\"/>";

TEST(UrdfJointsTest, ARobotFloatsOnAnEmptyLinkOfAnyName) {
  for (const std::string root : {"world", "map"}) {
    const auto [robot, messages] =
        ReadUrdf("<link name=\"" + root + "\"/>\n" + Body("base") + Body("arm") +
                 JointOf("floating", root, "base") + JointOf("revolute", "base", "arm", kLimit));
    ASSERT_NE(robot, nullptr) << messages;
    EXPECT_FALSE(robot->fixed_base);
    ASSERT_EQ(robot->links.size(), 2u);
    // At the pose of the floating joint.
    EXPECT_NEAR(robot->links[0].X_RL.p.z(), 1, 1e-12);
    EXPECT_THAT(messages, HasSubstr("joint 'base_j' of type floating is left out"));
  }
}

TEST(UrdfJointsTest, WhatFloatsOnALinkWithABodyMovesOnItsOwn) {
  const auto [robot, messages] = ReadUrdf(Body("base") + Body("ball") + JointOf("floating", "base", "ball"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 2u);
  EXPECT_NEAR(robot->links[1].X_RL.p.z() - robot->links[0].X_RL.p.z(), 1, 1e-12);
}

TEST(UrdfJointsTest, APlanarJointIsTwoWaysAndATurn) {
  const auto [robot, messages] = ReadUrdf(
      Body("base") + Body("puck") +
      JointOf("planar", "base", "puck", "<axis xyz=\"0 1 0\"/><limit effort=\"5\" velocity=\"3\"/>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 3u) << messages;
  std::vector<std::string> names;
  for (const JointModel& joint : robot->joints) {
    names.push_back(joint.name);
    EXPECT_EQ(joint.max_effort, 5);
    const bool turns = joint.name == "puck_j.rz";
    EXPECT_EQ(joint.kind, turns ? JointModel::Kind::kHinge : JointModel::Kind::kSlider);
    EXPECT_NEAR(std::abs(joint.axis_R.y()), turns ? 1 : 0, 1e-12);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("puck_j.x", "puck_j.y", "puck_j.rz"));
  EXPECT_THAT(messages, HasSubstr("joint 'puck_j' of type planar is three"));
}

TEST(UrdfJointsTest, APlanarJointMayHangOnTheWorld) {
  const auto [robot, messages] = ReadUrdf("<link name=\"world\"/>" + Body("puck") +
                                          JointOf("planar", "world", "puck", "<axis xyz=\"0 0 1\"/>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
  EXPECT_EQ(robot->joints.size(), 3u);
}

TEST(UrdfJointsTest, AnEmptyRootOnWhichItMovesInAPlaneIsTheWorld) {
  const auto [robot, messages] = ReadUrdf("<link name=\"odom\"/>" + Body("puck") +
                                          JointOf("planar", "odom", "puck", "<axis xyz=\"0 0 1\"/>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
  EXPECT_EQ(robot->joints.size(), 3u);
}

TEST(UrdfJointsTest, ProductsOfInertiaThatNoBodyHasAreMendedAndSaid) {
  std::string body = Body("base");
  body.replace(body.find("ixy=\"0\""), 7, "ixy=\"3\"");
  const auto [robot, messages] = ReadUrdf(body);
  ASSERT_NE(robot, nullptr) << messages;
  // Of the box of 0.2 m and 1 kg.
  EXPECT_NEAR((robot->links[0].inertia_kg_m2 - Vector3::Constant(0.04 / 6)).norm(), 0, 1e-12);
  EXPECT_THAT(messages, HasSubstr("the inertia of link 'base' is not that of a body"));
}

TEST(UrdfJointsTest, ATransmissionGivesItsJointAMotor) {
  const auto [robot, messages] = ReadUrdf(
      Body("base") + Body("arm") + JointOf("continuous", "base", "arm") +
      "<transmission name=\"t\"><joint name=\"arm_j\"><hardwareInterface>x</hardwareInterface></joint>"
      "</transmission>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].module, "joints");
  EXPECT_THAT(messages, HasSubstr("joint 'arm_j' says no <effort> or <velocity>"));
}

TEST(UrdfJointsTest, EachOfSeveralControlsIsAGroup) {
  const auto control = [](const std::string& name, const std::string& joint) {
    return "<ros2_control name=\"" + name + "\" type=\"system\"><joint name=\"" + joint +
           "\"><command_interface name=\"position\"/></joint></ros2_control>\n";
  };
  const auto [robot, messages] = ReadUrdf(
      Body("base") + Body("arm") + Body("hand") + Body("lid") + JointOf("revolute", "base", "arm", kLimit) +
      JointOf("revolute", "arm", "hand", kLimit) + JointOf("revolute", "base", "lid", kLimit) +
      control("Left Arm", "arm_j") + control("gripper", "hand_j"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 3u);
  EXPECT_EQ(robot->actuators[0].module, "left_arm");
  EXPECT_EQ(robot->actuators[1].module, "gripper");
  EXPECT_EQ(robot->actuators[2].module, "joints");  // not commanded by any plug-in
  EXPECT_THAT(messages, testing::Not(HasSubstr("ros2_control")));
}

TEST(UrdfJointsTest, ASafetyControllerIsSaidOnce) {
  const std::string safe = kLimit + "<safety_controller k_velocity=\"1\"/>";
  const auto [robot, messages] =
      ReadUrdf(Body("base") + Body("arm") + Body("hand") + JointOf("revolute", "base", "arm", safe) +
               JointOf("revolute", "arm", "hand", safe));
  ASSERT_NE(robot, nullptr) << messages;
  const std::size_t first = messages.find("<safety_controller>");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(messages.find("<safety_controller>", first + 1), std::string::npos);
}

TEST(UrdfJointsTest, WhatXacroHasWrittenIsNoXacro) {
  const TempFolder folder;
  folder.Write("rig.urdf", "<robot name=\"rig\"><!-- <xacro:if value=\"${a}\"> -->" + Body("base") +
                               "<!-- <xacro:b/> --></robot>");
  EXPECT_NE(ReadFile(folder, "rig.urdf").robot, nullptr);
}

TEST(UrdfJointsTest, XacroNeedsItsProgramAndFindsIt) {
  const TempFolder folder;
  folder.Write(
      "rig.urdf.xacro",
      "<robot name=\"rig\" xmlns:xacro=\"http://ros.org\"><xacro:property name=\"a\" value=\"1\"/></robot>");
  const auto program = folder.Write(
      "bin/xacro",
      "#!/bin/sh\necho \"warning: beside it\" >&2\ncat <<'X'\n<?xml version=\"1.0\"?>\n<robot name=\"rig\">" +
          Body("base") + "</robot>\nX\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const std::string path = getenv("PATH");
  setenv("PATH", folder.path().c_str(), 1);
  EXPECT_THAT(ReadFile(folder, "rig.urdf.xacro").messages,
              HasSubstr("error: this is xacro, and there is no program"));
  setenv("PATH", ((folder.path() / "bin").string() + ":" + path).c_str(), 1);
  const auto [robot, messages] = ReadFile(folder, "rig.urdf.xacro");
  folder.Write("bin/xacro", "#!/bin/sh\necho 'undefined: wheel' >&2\nexit 2\n");
  const std::string failed = ReadFile(folder, "rig.urdf.xacro").messages;
  folder.Write(
      "bin/xacro",
      "#!/bin/sh\nprintf 'warning: old\\nerror: resource not found: rig_parts\\nwhen processing file: "
      "a.xacro\\n' >&2\nexit 2\n");
  const std::string missing = ReadFile(folder, "rig.urdf.xacro").messages;
  folder.Write("bin/xacro", "#!/bin/sh\necho 'error: Undefined substitution argument name ' >&2\nexit 2\n");
  const std::string unnamed = ReadFile(folder, "rig.urdf.xacro").messages;
  folder.Write("bin/xacro", "#!/bin/sh\necho '<robot name=\"rig\"/>'\n");
  const std::string empty = ReadFile(folder, "rig.urdf.xacro").messages;
  setenv("PATH", path.c_str(), 1);
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->type, "rig");
  EXPECT_THAT(failed, HasSubstr("error: xacro: undefined: wheel"));
  EXPECT_THAT(missing, HasSubstr("error: xacro: resource not found: rig_parts: xacro finds packages in the "
                                 "folders of ROS_PACKAGE_PATH"));
  EXPECT_THAT(unnamed, HasSubstr("xacro: Undefined substitution argument name: give it one, xacro FILE "
                                 "NAME:=VALUE > robot.urdf, and load that"));
  EXPECT_THAT(empty,
              HasSubstr("error: xacro wrote no <link>: the file holds macros alone; load the file that "
                        "uses them"));
}

}  // namespace
}  // namespace coopdyn
