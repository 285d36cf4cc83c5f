// SPDX-License-Identifier: MIT
// Effects of Gazebo's plug-ins on a model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "server/model/missing_files.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn::gazebo_plugins {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kBase = SdfLink("base", "0 0 0.15 0 0 0", kSdfBox);

/// A wheel at x, y and its joint, NAME_j.
std::string Wheel(const std::string& name, double x, double y) {
  return SdfLink(name, std::to_string(x) + " " + std::to_string(y) + " 0.05 -1.570796326794897 0 0",
                 "<cylinder><radius>0.05</radius><length>0.02</length></cylinder>") +
         "<joint name=\"" + name + "_j\" type=\"revolute\"><parent>base</parent><child>" + name +
         "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
}
const std::string kCar =
    kBase + Wheel("a", 0.1, 0.2) + Wheel("b", 0.1, -0.2) + Wheel("c", -0.1, 0.2) + Wheel("d", -0.1, -0.2);

std::string Plugin(const std::string& file, const std::string& name, const std::string& inside) {
  return "<plugin filename=\"" + file + "\" name=\"" + name + "\">" + inside + "</plugin>\n";
}

std::vector<std::string> JointsOf(const RobotModel& robot, const std::string& module) {
  std::vector<std::string> names;
  for (const ActuatorModel& actuator : robot.actuators) {
    for (const int joint : actuator.joints) {
      if (actuator.module == module) names.push_back(robot.joints[static_cast<std::size_t>(joint)].name);
    }
  }
  return names;
}

TEST(GazeboPluginsTest, AClassicSkidSteerDriveHasFourWheels) {
  for (const std::string& plugin :
       {Plugin("libgazebo_ros_skid_steer_drive.so", "s",
               "<leftFrontJoint>a_j</leftFrontJoint><rightFrontJoint>b_j</rightFrontJoint>"
               "<leftRearJoint>c_j</leftRearJoint><rightRearJoint>d_j</rightRearJoint><torque>7</torque>"),
        Plugin("libSkidSteerDrivePlugin.so", "s",
               "<left_front>a_j</left_front><right_front>b_j</right_front><left_rear>c_j</left_rear>"
               "<right_rear>d_j</right_rear><torque>7</torque>")}) {
    const auto [robot, messages] = ReadSdf(kCar + plugin);
    ASSERT_NE(robot, nullptr) << messages;
    ASSERT_NE(robot->drive(), nullptr) << messages;
    EXPECT_EQ(robot->couplings.size(), 2u) << messages;
    EXPECT_EQ(robot->drive()->max_torque_nm, 7);
  }
}

TEST(GazeboPluginsTest, AMecanumDriveIsAGroupOfItsWheels) {
  const auto [robot, messages] = ReadSdf(
      kCar + Plugin("gz-sim-mecanum-drive-system", "gz::sim::systems::MecanumDrive",
                    "<back_right_joint>d_j</back_right_joint><front_right_joint>b_j</front_right_joint>"
                    "<front_left_joint>a_j</front_left_joint><back_left_joint>c_j</back_left_joint>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(JointsOf(*robot, "wheels"), ElementsAre("a_j", "b_j", "c_j", "d_j")) << messages;
  EXPECT_THAT(messages, HasSubstr("the Mecanum drive is the group 'wheels'"));
}

/// A hull with a propeller on a joint about z; `plugin` drives it.
ForeignAnswer ReadCraft(const std::string& plugin) {
  std::string rotor = SdfLink("rotor", "0.3 0 0.3 0 0 0", "<sphere><radius>0.05</radius></sphere>");
  return ReadSdf(kBase + rotor +
                 "<joint name=\"rotor_j\" type=\"revolute\"><parent>base</parent><child>rotor</child><axis>"
                 "<xyz>0 0 1</xyz><limit><effort>1</effort><velocity>9</velocity></limit></axis></joint>\n" +
                 plugin);
}
const std::string kMotor =
    "<jointName>rotor_j</jointName><linkName>rotor</linkName><maxRotVelocity>1000</maxRotVelocity>"
    "<motorConstant>1e-5</motorConstant><momentConstant>0.02</momentConstant>";

TEST(GazeboPluginsTest, AMotorModelIsAThrusterWithItsReaction) {
  for (const auto& [file, name] :
       {std::pair("gz-sim-multicopter-motor-model-system", "gz::sim::systems::MulticopterMotorModel"),
        std::pair("libgazebo_motor_model.so", "front_right_motor_model"),
        std::pair("librotors_gazebo_motor_model.so", "m")}) {
    for (const auto& [turning, reaction] : {std::pair("ccw", -0.02), std::pair("cw", 0.02)}) {
      const auto [robot, messages] =
          ReadCraft(Plugin(file, name, kMotor + "<turningDirection>" + turning + "</turningDirection>"));
      ASSERT_NE(robot, nullptr) << messages;
      ASSERT_THAT(JointsOf(*robot, "thrusters"), ElementsAre("rotor")) << file << messages;
      const JointModel& thruster = robot->joints.back();
      EXPECT_EQ(thruster.kind, JointModel::Kind::kForce);
      EXPECT_NEAR(thruster.max_effort, 10, 1e-9);  // k ω²
      EXPECT_NEAR(thruster.torque_per_force_m, reaction, 1e-12);
      EXPECT_TRUE(thruster.axis_R.isApprox(Vector3::UnitZ()));
      EXPECT_TRUE(thruster.p_RJ.isApprox(Vector3(0.3, 0, 0.3), 1e-9));
      EXPECT_EQ(thruster.child, 0);                            // the propeller's mount
      EXPECT_THAT(JointsOf(*robot, "joints"), ElementsAre());  // the propeller turns freely
    }
  }
}

TEST(GazeboPluginsTest, AThrusterPushesAlongTheAxisOfItsJoint) {
  const auto [robot, messages] =
      ReadCraft(Plugin("gz-sim-thruster-system", "gz::sim::systems::Thruster",
                       "<joint_name>rotor_j</joint_name><thrust_coefficient>0.004</thrust_coefficient>"
                       "<fluid_density>1000</fluid_density><propeller_diameter>0.2</propeller_diameter>"
                       "<max_thrust_cmd>300</max_thrust_cmd>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_THAT(JointsOf(*robot, "thrusters"), ElementsAre("rotor")) << messages;
  EXPECT_EQ(robot->joints.back().max_effort, 300);
  EXPECT_EQ(robot->joints.back().torque_per_force_m, 0);
}

TEST(GazeboPluginsTest, AThrusterWithoutItsLinkIsLeftOutAndThatIsSaid) {
  const auto [robot, messages] = ReadCraft(
      Plugin("gz-sim-thruster-system", "gz::sim::systems::Thruster", "<joint_name>none</joint_name>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("the thruster of 'none' is left out, since the model has no such link"));
}

TEST(GazeboPluginsTest, AThrusterOfASpacecraftPushesAlongZOfItsLink) {
  const auto [robot, messages] =
      ReadCraft(Plugin("gz-sim-spacecraft-thruster-model-system", "gz::sim::systems::SpacecraftThrusterModel",
                       "<link_name>base</link_name><max_thrust>1.4</max_thrust>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_THAT(JointsOf(*robot, "thrusters"), ElementsAre("base")) << messages;
  EXPECT_EQ(robot->joints.back().max_effort, 1.4);
  EXPECT_EQ(robot->joints.back().child, 0);
}

TEST(GazeboPluginsTest, AMotorModelOfAnotherKindIsLeftOut) {
  const auto [robot, messages] =
      ReadCraft(Plugin("libGenericMotorModelPlugin.so", "gz::sim::systems::GenericMotorModel", kMotor) +
                Plugin("libgazebo_motor_model.so", "m", kMotor + "<motorType>position</motorType>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(JointsOf(*robot, "thrusters"), ElementsAre());
  EXPECT_THAT(messages, AllOf(HasSubstr("plug-in 'libGenericMotorModelPlugin.so' is not used"),
                              HasSubstr("plug-in 'libgazebo_motor_model.so' is not used")));
}

TEST(GazeboPluginsTest, AJointWithoutDirectionAndWayIsFixed) {
  const auto [robot, messages] = ReadSdf(
      kBase + SdfLink("leg", "0 0 0.4 0 0 0", kSdfBox) +
      "<joint name=\"ft\" type=\"revolute\"><parent>base</parent><child>leg</child><axis><xyz>0 0 0</xyz>"
      "<limit><lower>0</lower><upper>0</upper></limit></axis>"
      "<sensor name=\"s\" type=\"force_torque\"><always_on>1</always_on></sensor></joint>\n");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->joints.empty());
  EXPECT_EQ(robot->links.size(), 1u);
  EXPECT_NE(robot->Find<WrenchModel>(), nullptr);
  EXPECT_THAT(messages, HasSubstr("joint 'ft' has no direction and no way to go: it is taken as fixed"));
}

TEST(GazeboPluginsTest, NamesInAModelInsideAreThoseOfThatModel) {
  const auto [robot, messages] = ReadSdf(
      "<model name=\"in\">" + kBase + SdfLink("arm", "0 0 0.4 0 0 0", "<box><size>0.1 0.1 0.1</size></box>") +
          "<joint name=\"j\" type=\"revolute\"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz>"
          "</axis></joint>\n" +
          Plugin("gz-sim-joint-controller-system", "gz::sim::systems::JointController",
                 "<joint_name>j</joint_name>") +
          "</model>",
      "1.7");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(JointsOf(*robot, "joints"), ElementsAre("in::j")) << messages;
}

TEST(GazeboPluginsTest, WhatIsThereAnywayIsToldInOneLine) {
  const auto [robot, messages] = ReadSdf(
      kBase + Plugin("gz-sim-joint-state-publisher-system", "gz::sim::systems::JointStatePublisher", "") +
      Plugin("gz-sim-pose-publisher-system", "gz::sim::systems::PosePublisher", "") +
      Plugin("gz-sim-pose-publisher-system", "gz::sim::systems::PosePublisher", "") +
      Plugin("libgazebo_ros_p3d.so", "truth", ""));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("what these plug-ins give is there anyway, sensors as their <sensor> says: "
                                  "gz::sim::systems::JointStatePublisher, gz::sim::systems::PosePublisher, "
                                  "libgazebo_ros_p3d.so\n"));
  EXPECT_THAT(messages, Not(HasSubstr("not used")));
}

TEST(GazeboPluginsTest, OthersAreToldOnceWithWhyTheyMatter) {
  const std::string fin = Plugin("gz-sim-lift-drag-system", "gz::sim::systems::LiftDrag", "");
  const auto [robot, messages] = ReadSdf(
      kBase + fin + fin + fin +
      Plugin("gz-sim-detachable-joint-system", "gz::sim::systems::DetachableJoint",
             "<parent_link>base</parent_link><child_model>box</child_model><child_link>l</child_link>") +
      Plugin("gz-sim-track-controller-system", "gz::sim::systems::TrackController", "<link>t</link>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(
      messages,
      AllOf(HasSubstr("plug-in 'gz-sim-lift-drag-system' is not used by coopdyn: air and water do not "
                      "push wings and fins, so planes do not fly and rudders do not steer (also 2 more "
                      "times)"),
            HasSubstr("'box' is not attached, and moves on its own"), HasSubstr("its tracks do not move")));
}

/// A robot of two boards, with files in `folder`.
std::string TwoBoards(const std::string& file, const std::string& inside = {}) {
  return "<sdf version=\"1.6\"><model name=\"rig\">\n" + kCar +
         Plugin("gz-sim-yarp-controlboard-system", "gzyarp::ControlBoard",
                "<yarpConfigurationFile>model://rig/conf/front.ini</yarpConfigurationFile>" + inside) +
         Plugin("libgazebo_yarp_controlboard.so", "controlboard_rear",
                "<yarpConfigurationFile>" + file + "</yarpConfigurationFile>") +
         Plugin("libgazebo_yarp_imu.so", "imu", "") + "</model></sdf>";
}
void WriteBoards(const TempFolder& folder) {
  folder.Write("rig/model.config", "<model><sdf>model.sdf</sdf></model>");
  folder.Write("rig/conf/front.ini", "yarpDeviceName front_hardware_device\njointNames b_j a_j\n");
  folder.Write("rig/conf/rear.ini",
               "[WRAPPER]\nname /${gazeboYarpPluginsRobotName}/rear\nnetworks ( r )\nr 0 1 0 1\n[r]\n"
               "jointNames c_j d_j\n");
}

TEST(GazeboPluginsTest, ControlBoardsOfYarpAreGroupsInTheirOrder) {
  const TempFolder folder;
  WriteBoards(folder);
  folder.Write("rig/model.sdf", TwoBoards("model://rig/conf/rear.ini",
                                          "<initialConfiguration>1 2"
                                          "</initialConfiguration>"));
  const auto [robot, messages] = ReadFile(folder, "rig/model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(JointsOf(*robot, "front"), ElementsAre("b_j", "a_j")) << messages;
  EXPECT_THAT(JointsOf(*robot, "rear"), ElementsAre("c_j", "d_j")) << messages;
  EXPECT_THAT(messages, HasSubstr("there anyway, sensors as their <sensor> says: libgazebo_yarp_imu.so"));
  EXPECT_THAT(messages, HasSubstr("<initialConfiguration> is not used by coopdyn"));
}

TEST(GazeboPluginsTest, ABoardWhoseFileIsNowhereIsSaid) {
  for (const std::string& file : {std::string("model://rig/conf/none.ini"),
                                  std::string("../../../etc/passwd"), std::string("model://rig/conf")}) {
    const TempFolder folder;
    WriteBoards(folder);
    folder.Write("rig/model.sdf", TwoBoards(file));
    const auto [robot, messages] = ReadFile(folder, "rig/model.sdf");
    ASSERT_NE(robot, nullptr) << messages;
    EXPECT_THAT(JointsOf(*robot, "front"), ElementsAre("b_j", "a_j")) << messages;
    EXPECT_THAT(JointsOf(*robot, "rear"), ElementsAre());
    EXPECT_THAT(messages, HasSubstr("the control board of '" + file + "' is left out"));
  }
}

TEST(GazeboPluginsTest, TheFileOfABoardThatIsNowhereIsLookedFor) {
  const TempFolder folder;
  WriteBoards(folder);
  const std::string file = folder.Write("rig/model.sdf", TwoBoards("model://other/rear.ini"));
  EXPECT_THAT(MissingUris(file, SearchPath()), ElementsAre("model://other/rear.ini"));
}

TEST(GazeboPluginsTest, ARecordedRobotHasItsBoardsWithoutTheirFiles) {
  const TempFolder folder;
  WriteBoards(folder);
  folder.Write("rig/model.sdf", TwoBoards("model://rig/conf/rear.ini"));
  const auto robot = ReadFile(folder, "rig/model.sdf").robot;
  ASSERT_NE(robot, nullptr);
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "recorded", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_THAT(JointsOf(*again, "front"), ElementsAre("b_j", "a_j"));
  EXPECT_THAT(JointsOf(*again, "rear"), ElementsAre("c_j", "d_j"));
}

}  // namespace
}  // namespace coopdyn::gazebo_plugins
