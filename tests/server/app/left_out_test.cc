// SPDX-License-Identifier: MIT
// The consequences of ignored parts of a model.
#include "server/app/left_out.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(LeftOutTest, APlugInWhoseSensorIsThereIsNoLossAndNamesTheModule) {
  RobotModel robot;
  EXPECT_TRUE(ConsequenceOf("plug-in 'libgazebo_ros_imu.so'", &robot).matters);
  robot.AddSensor("imu_2", ImuModel{});
  const Consequence anyway = ConsequenceOf("plug-in 'libgazebo_ros_imu.so'", &robot);
  EXPECT_FALSE(anyway.matters);
  EXPECT_EQ(anyway.why, "module 'imu_2' is there anyway");
}

TEST(LeftOutTest, AWordInTheMiddleOfAnotherIsNotMeant) {
  RobotModel robot;
  robot.AddSensor("imu", ImuModel{});
  EXPECT_TRUE(ConsequenceOf("plug-in 'libsimulator.so'", &robot).matters);  // s-imu-lator
}

TEST(LeftOutTest, NamesOfPlugInsAreWordsInAnyWriting) {
  for (const char* name : {"JointStatePublisher", "gz-sim-joint-state-publisher-system",
                           "libgazebo_ros_joint_state_publisher.so"}) {
    EXPECT_FALSE(ConsequenceOf("plug-in '" + std::string(name) + "'", nullptr).matters) << name;
  }
}

TEST(LeftOutTest, WhatFliesDoesNotFlyWithoutThrusters) {
  RobotModel robot;
  const std::string rotor = "plug-in 'libgazebo_motor_model.so'";
  EXPECT_TRUE(ConsequenceOf(rotor, &robot).matters);
  EXPECT_NE(ConsequenceOf(rotor, &robot).why.find("will not fly"), std::string::npos);
  robot.actuators.push_back({"thrusters", {}, ThrustersModel{}});
  EXPECT_FALSE(ConsequenceOf(rotor, &robot).matters);
}

TEST(LeftOutTest, AnUnknownPlugInMatters) {
  EXPECT_TRUE(ConsequenceOf("plug-in 'libfoo.so'", nullptr).matters);
}

TEST(LeftOutTest, LooksAndSolversAreNoLossGravityIs) {
  for (const char* what : {"<material> in <gazebo reference>", "<maxVel> in <gazebo reference>",
                           "<plugin> in <sensor>", "<background> in <scene>"}) {
    EXPECT_FALSE(ConsequenceOf(what, nullptr).matters) << what;
  }
  for (const char* what : {"<gravity> in <link>", "<sensor type=\"gps\"> in <link>", "<banana> in <model>",
                           "<wind> in <world>"}) {
    EXPECT_TRUE(ConsequenceOf(what, nullptr).matters) << what;
    EXPECT_FALSE(ConsequenceOf(what, nullptr).why.empty()) << what;
  }
}

TEST(LeftOutTest, ASensorOfUrdfIsNoLossIfGazeboHasSensors) {
  RobotModel robot;
  EXPECT_TRUE(ConsequenceOf("<sensor> in <robot>", &robot).matters);
  robot.AddSensor("imu", ImuModel{});
  EXPECT_FALSE(ConsequenceOf("<sensor> in <robot>", &robot).matters);
}

TEST(LeftOutTest, ACollisionThatGazeboTunesIsNoLoss) {
  EXPECT_FALSE(ConsequenceOf("<collision> in <gazebo reference>", nullptr).matters);
  EXPECT_TRUE(ConsequenceOf("<collision> in <visual>", nullptr).matters);
  EXPECT_FALSE(ConsequenceOf("<mujoco> in <robot>", nullptr).matters);
  EXPECT_FALSE(ConsequenceOf("<friction2> in <bullet>", nullptr).matters);
}

TEST(LeftOutTest, DecorationAndIntegratorsOfMujocoAreNoLoss) {
  for (const char* text : {"what only decorates the world is left out (3 times)",
                           "'implicitfast' of 'integrator' of <option> is not known to libmujoco 2.3"})
    EXPECT_FALSE(ConsequenceOf(Diagnostic{Diagnostic::Level::kWarning, {}, text}, nullptr).matters) << text;
}

}  // namespace
}  // namespace coopdyn
