// SPDX-License-Identifier: MIT
// <coopdyn:drivetrain> in a joint, and its errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>

#include "server/model/readers.h"

namespace coopdyn::drive_train_reader {
namespace {

using ::testing::HasSubstr;

const std::string kRow = "<coopdyn:pwm duty=\"1\" no_load_speed_rad_s=\"50\" stall_torque_nm=\"0.2\"/>\n";

/// A robot of two links whose joint has `train` in line 4.
std::string TextWith(const std::string& train, const std::string& axis = "<xyz>0 0 1</xyz>",
                     const std::string& more = "", const std::string& type = "revolute") {
  const auto link = [](const char* name, const char* pose) {
    return std::string("<link name=\"") + name + "\"><pose>" + pose +
           "</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
           "</inertial><collision name=\"c\"><geometry><box><size>0.1 0.1 "
           "0.1</size></box></geometry></collision>"
           "</link>";
  };
  return "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">\n" +
         link("a", "0 0 1 0 0 0") + link("b", "0 0 2 0 0 0") + "\n<joint name=\"j\" type=\"" + type +
         "\"><parent>a</parent><child>b</child><axis>" + axis + "</axis>\n" + train + "</joint>\n" + more +
         "</model></sdf>";
}

std::string Train(const std::string& attributes, const std::string& rows = kRow) {
  return "<coopdyn:drivetrain " + attributes + ">\n" + rows + "</coopdyn:drivetrain>";
}

struct ReadRig {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

ReadRig Read(const std::string& text) {
  Diagnostics diagnostics;
  ReadRig read;
  read.robot = ReadRobotModelText(text, "rig/model.sdf", "rig", diagnostics);
  read.messages = diagnostics.ToString();
  return read;
}

TEST(DriveTrainReaderTest, EveryAttributeIsRead) {
  const auto [robot, messages] = Read(TextWith(Train(
      "ratio=\"10\" efficiency=\"0.8\" rotor_inertia_kg_m2=\"2e-6\" backlash_deg=\"9\" "
      "stiffness_nm_rad=\"30\" "
      "damping_nms_rad=\"0.1\" preload_nm=\"0.3\" static_friction_nm=\"0.5\" dynamic_friction_nm=\"0.4\" "
      "stiction_speed_rad_s=\"0.01\" torque_constant_nm_a=\"0.05\" brake_nms_rad=\"0.003\"",
      "<coopdyn:pwm duty=\"0.5\" no_load_speed_rad_s=\"20\" stall_torque_nm=\"0.1\" stall_current_a=\"7\"/>" +
          kRow)));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_TRUE(robot->joints[0].drive_train);
  const DriveTrainModel& train = *robot->joints[0].drive_train;
  EXPECT_EQ(train.ratio, 10);
  EXPECT_EQ(train.efficiency, 0.8);
  EXPECT_EQ(train.rotor_inertia_kg_m2, 2e-6);
  EXPECT_NEAR(train.backlash_rad, std::numbers::pi / 20, 1e-12);
  EXPECT_EQ(train.stiffness_nm_rad, 30);
  EXPECT_EQ(train.damping_nms_rad, 0.1);
  EXPECT_EQ(train.preload_nm, 0.3);
  EXPECT_EQ(train.static_friction_nm, 0.5);
  EXPECT_EQ(train.dynamic_friction_nm, 0.4);
  EXPECT_EQ(train.stiction_speed_rad_s, 0.01);
  EXPECT_EQ(train.brake_nms_rad, 0.003);
  ASSERT_EQ(train.pwm.size(), 2u);
  EXPECT_EQ(train.pwm[0].stall_current_a, 7);
  EXPECT_NEAR(train.pwm[1].stall_current_a, 4, 1e-12);
}

TEST(DriveTrainReaderTest, WithoutALimitTheJointHasThoseOfItsMotor) {
  const auto [robot, messages] = Read(TextWith(Train("ratio=\"10\"")));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].max_effort, 2);
  EXPECT_EQ(robot->joints[0].max_velocity, 5);
  EXPECT_EQ(robot->actuators.at(0).module, "joints");
}

TEST(DriveTrainReaderTest, AShortCircuitBrakesAsTheFullDutyPulls) {
  const auto [robot, messages] = Read(TextWith(Train("")));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NEAR(robot->joints[0].drive_train->brake_nms_rad, 0.2 / 50, 1e-12);
}

TEST(DriveTrainReaderTest, HostileValuesAreErrorsAtTheirLine) {
  for (const char* attribute :
       {"ratio=\"0\"", "ratio=\"nan\"", "efficiency=\"1.1\"", "efficiency=\"0\"",
        "rotor_inertia_kg_m2=\"-1\"", "rotor_inertia_kg_m2=\"0\"", "backlash_deg=\"-1\"",
        "stiffness_nm_rad=\"inf\"", "stiffness_nm_rad=\"0\"", "preload_nm=\"-1\"",
        "static_friction_nm=\"nan\"", "wrong=\"1\"", "torque_constant_nm_a=\"0\"", "preload_nm=\"1\"",
        "dynamic_friction_nm=\"1\" static_friction_nm=\"0.5\""}) {
    const auto [robot, messages] = Read(TextWith(Train(attribute)));
    EXPECT_EQ(robot, nullptr) << attribute;
    EXPECT_THAT(messages, HasSubstr("rig/model.sdf:4: error: <coopdyn:drivetrain>")) << attribute;
  }
}

TEST(DriveTrainReaderTest, HostileRowsAreErrorsAtTheirLine) {
  for (const char* row :
       {"duty=\"0\" no_load_speed_rad_s=\"1\" stall_torque_nm=\"1\"",
        "duty=\"1.5\" no_load_speed_rad_s=\"1\" stall_torque_nm=\"1\"",
        "duty=\"1\" no_load_speed_rad_s=\"0\" stall_torque_nm=\"1\"",
        "duty=\"1\" no_load_speed_rad_s=\"1\" stall_torque_nm=\"-1\"", "duty=\"1\" stall_torque_nm=\"1\""}) {
    const auto [robot, messages] = Read(TextWith(Train("", std::string("<coopdyn:pwm ") + row + "/>\n")));
    EXPECT_EQ(robot, nullptr) << row;
    EXPECT_THAT(messages, HasSubstr("rig/model.sdf:5: error: <coopdyn:pwm>")) << row;
  }
}

TEST(DriveTrainReaderTest, RowsStandByTheirDuty) {
  EXPECT_THAT(Read(TextWith(Train("", kRow + kRow))).messages,
              HasSubstr("rig/model.sdf:6: error: <coopdyn:pwm>: each row needs a larger 'duty'"));
}

TEST(DriveTrainReaderTest, AMotorNeedsARow) {
  EXPECT_THAT(Read(TextWith(Train("", ""))).messages, HasSubstr("needs a row, for example <coopdyn:pwm"));
}

TEST(DriveTrainReaderTest, ASliderHasNone) {
  EXPECT_THAT(Read(TextWith(Train(""), "<xyz>0 0 1</xyz>", "", "prismatic")).messages,
              HasSubstr("only a revolute or continuous joint has one"));
}

TEST(DriveTrainReaderTest, AJointOutsideOfEachGroupHasNone) {
  EXPECT_THAT(
      Read(TextWith(Train(""), "<xyz>0 0 1</xyz><limit><effort>0</effort></limit>")).messages,
      HasSubstr("rig/model.sdf:3: error: joint 'j' has a <coopdyn:drivetrain> and belongs to no group"));
}

}  // namespace
}  // namespace coopdyn::drive_train_reader
