// SPDX-License-Identifier: MIT
// The lines that coopdyn check prints for a first drive; tests/daemon/check_drive_test.py runs some.
#include "server/app/drive_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using testing::HasSubstr;

RobotModel Arm(double lower, double upper, const std::string& joint_name = "elbow") {
  RobotModel model;
  model.links.resize(2);
  JointModel joint;
  joint.name = joint_name;
  joint.child = 1;
  joint.lower = lower;
  joint.upper = upper;
  model.joints.push_back(joint);
  model.actuators.push_back({"arm", {0}, BoardModel{}});
  return model;
}

TEST(DriveLinesTest, AJointGoesWhereItsLimitsLetIt) {
  const RobotModel up = Arm(0, 2), down = Arm(-1, 0.01);
  EXPECT_THAT(DriveLinesFor("a.urdf", "", "robot1", &up).python,
              HasSubstr("j.set_positions(0.3, 'elbow')\n"));
  EXPECT_THAT(DriveLinesFor("a.urdf", "", "robot1", &down).python,
              HasSubstr("j.set_positions(-0.3, 'elbow')\n"));
}

TEST(DriveLinesTest, YarpCountsDegrees) {
  const RobotModel arm = Arm(-1, 1);
  EXPECT_THAT(DriveLinesFor("a.urdf", "", "robot1", &arm).yarp,
              HasSubstr("echo 'set pos 0 17.189' | yarp rpc /robot1/arm/rpc:i\n"));
}

TEST(DriveLinesTest, AJointWithANameThatIsNoPlainWordIsCalledByItsNumber) {
  for (const std::string& name :
       {std::string("a'); quit('"), std::string("a b"), std::string("\x1b[2J"), std::string(5000, 'x')}) {
    const RobotModel arm = Arm(-1, 1, name);
    const DriveLines lines = DriveLinesFor("a.urdf", "", "robot1", &arm);
    EXPECT_THAT(lines.python, HasSubstr("j.set_positions(0.3, 1)\n"));
    EXPECT_THAT(lines.matlab, HasSubstr("j.set_positions(0.3, 1);\n"));
  }
}

TEST(DriveLinesTest, WhatDoesNotMoveIsRead) {
  RobotModel model;
  model.AddSensor("pose", PoseModel{});
  EXPECT_THAT(DriveLinesFor("a.urdf", "", "robot1", &model).python, HasSubstr("print(r.get_pose_3d())"));
  model.AddSensor("imu_2", ImuModel{});
  const DriveLines lines = DriveLinesFor("a.urdf", "", "robot1", &model);
  EXPECT_THAT(lines.python, HasSubstr("print(r.get_imu('imu_2'))"));
  EXPECT_THAT(lines.matlab, HasSubstr("disp(r.get_imu('imu_2'))"));
  EXPECT_THAT(lines.yarp, HasSubstr("/robot1/imu_2/state:o\n"));
}

TEST(DriveLinesTest, ThrustersCarryATenthMoreThanTheWeight) {
  RobotModel copter;
  copter.links.resize(1);
  copter.links[0].mass_kg = 2;
  JointModel rotor;
  rotor.kind = JointModel::Kind::kForce;
  rotor.max_effort = 20;
  copter.joints = {rotor, rotor};
  copter.actuators.push_back({"thrusters", {0, 1}, ThrustersModel{}});
  const DriveLines lines = DriveLinesFor("a.sdf", "", "robot1", &copter);
  EXPECT_THAT(lines.python, HasSubstr("t.set_thrusts([10.791, 10.791])\n"));  // 1.1 · 2 · 9.81 / 2
  EXPECT_THAT(lines.yarp, HasSubstr("echo 'set_thrusts (1 2) 10.791 10.791' | yarp rpc /robot1/thrusters\n"));
  copter.joints[0].max_effort = copter.joints[1].max_effort = 5;  // a boat
  copter.joints[0].name = "screw";
  EXPECT_THAT(DriveLinesFor("a.sdf", "", "robot1", &copter).python, HasSubstr("t.set_thrusts(2.5, 'screw')"));
}

TEST(DriveLinesTest, MecanumWheelsGetSpeeds) {
  RobotModel cart = Arm(-1, 1);
  cart.actuators[0].module = "wheels";
  EXPECT_THAT(DriveLinesFor("a.sdf", "", "robot1", &cart).python, HasSubstr("j.set_velocities([2])\n"));
}

TEST(DriveLinesTest, ProgramsRunForASecond) {
  const RobotModel arm = Arm(-1, 1);
  EXPECT_THAT(DriveLinesFor("a.urdf", "", "robot1", &arm, 0.004).python, HasSubstr("range(250)"));
  EXPECT_THAT(DriveLinesFor("a.urdf", "", "robot1", &arm, 0.004).matlab, HasSubstr("k = 1:250,"));
}

TEST(DriveLinesTest, AFileNameIsOneWordOfTheShell) {
  EXPECT_EQ(ShellWord("models/a-1.urdf"), "models/a-1.urdf");
  EXPECT_EQ(ShellWord("my robot.urdf"), "'my robot.urdf'");
  EXPECT_EQ(ShellWord("a'; rm b"), "'a'\\''; rm b'");
  EXPECT_EQ(ShellWord(""), "''");
}

}  // namespace
}  // namespace coopdyn
