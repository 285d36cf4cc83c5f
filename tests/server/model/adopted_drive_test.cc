// SPDX-License-Identifier: MIT
// Drives made from Gazebo's plug-ins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A wheel at x, y and its joint, NAME_j.
std::string Wheel(const std::string& name, double x, double y) {
  return SdfLink(name, std::to_string(x) + " " + std::to_string(y) + " 0.05 -1.570796326794897 0 0",
                 "<cylinder><radius>0.05</radius><length>0.02</length></cylinder>") +
         "<joint name=\"" + name + "_j\" type=\"revolute\"><parent>base</parent><child>" + name +
         "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
}

TEST(AdoptedDriveTest, ADriveOfGazeboHasAModuleAndItsOriginUnderTheAxle) {
  const auto [robot, messages] = ReadSdf(
      SdfLink("base", "0 0 0.15 0 0 0", kSdfBox) + Wheel("left", 0.1, 0.2) + Wheel("right", 0.1, -0.2) +
      "<plugin filename=\"libgazebo_ros_diff_drive.so\" name=\"d\"><leftJoint>left_j</leftJoint>"
      "<rightJoint>right_j</rightJoint><wheelTorque>3</wheelTorque></plugin>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  EXPECT_NEAR(robot->drive()->track_m, 0.4, 1e-9);
  EXPECT_NEAR(robot->drive()->wheel_radius_m, 0.05, 1e-9);
  EXPECT_EQ(robot->drive()->max_torque_nm, 3);
  EXPECT_NEAR(robot->links[0].X_RL.p.x(), -0.1, 1e-9);
  EXPECT_EQ(robot->modules()[0].type, "motors");
}

/// A car of four wheels, a and b in front, a and c on the left; `joints`: of its DiffDrive.
ForeignAnswer ReadCar(const std::string& joints) {
  return ReadSdf(SdfLink("base", "0 0 0.15 0 0 0", kSdfBox) + Wheel("a", 0.1, 0.2) + Wheel("b", 0.1, -0.2) +
                 Wheel("c", -0.1, 0.2) + Wheel("d", -0.1, -0.2) +
                 "<plugin filename=\"gz-sim-diff-drive-system\" name=\"gz::sim::systems::DiffDrive\">" +
                 joints + "</plugin>\n");
}
/// The joint that follows another one, and how.
std::pair<std::string, double> LeaderOf(const RobotModel& robot, const std::string& follower) {
  for (const CouplingModel& one : robot.couplings) {
    if (robot.joints[static_cast<std::size_t>(one.follower)].name == follower)
      return {robot.joints[static_cast<std::size_t>(one.leader)].name, one.multiplier};
  }
  return {};
}

TEST(AdoptedDriveTest, AllWheelsOfADriveOfGazeboTurn) {
  const auto [robot, messages] = ReadCar(
      "<left_joint>a_j</left_joint><left_joint>c_j</left_joint><right_joint>b_j</right_joint>"
      "<right_joint>d_j</right_joint>");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  ASSERT_EQ(robot->couplings.size(), 2u) << messages;
  EXPECT_EQ(LeaderOf(*robot, "c_j"), std::pair(std::string("a_j"), 1.0));
  EXPECT_EQ(LeaderOf(*robot, "d_j"), std::pair(std::string("b_j"), 1.0));
}

TEST(AdoptedDriveTest, TheWheelsOfADriveOfGazeboStandInAnyOrder) {
  for (const std::string& joints :
       {std::string("<left_joint>a_j</left_joint><left_joint>c_j</left_joint><right_joint>d_j</right_joint>"
                    "<right_joint>b_j</right_joint>"),
        std::string("<right_joint>d_j</right_joint><left_joint>a_j</left_joint><right_joint>b_j</right_joint>"
                    "<left_joint>c_j</left_joint>")}) {
    const auto [robot, messages] = ReadCar(joints);
    ASSERT_NE(robot, nullptr) << messages;
    ASSERT_NE(robot->drive(), nullptr) << messages;
    EXPECT_THAT(messages, Not(HasSubstr("is named")));
    EXPECT_NEAR(robot->drive()->track_m, 0.4, 1e-9);
    EXPECT_EQ(LeaderOf(*robot, "c_j"), std::pair(std::string("a_j"), 1.0));
    EXPECT_EQ(LeaderOf(*robot, "d_j"), std::pair(std::string("b_j"), 1.0));
  }
}

TEST(AdoptedDriveTest, AWheelOfADriveOfGazeboTurnsWithItsSideWhateverItIsNamed) {
  const auto [robot, messages] = ReadCar(
      "<left_joint>a_j</left_joint><left_joint>b_j</left_joint><right_joint>c_j</right_joint>"
      "<right_joint>d_j</right_joint>");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  EXPECT_EQ(LeaderOf(*robot, "c_j").first, "a_j");
  EXPECT_EQ(LeaderOf(*robot, "d_j").first, "b_j");
  EXPECT_THAT(messages, HasSubstr("the wheel at 'b_j' is named left and is on the right, where y is smaller: "
                                  "it turns as a right one; write <right_joint>"));
  EXPECT_THAT(messages, HasSubstr("the wheel at 'c_j' is named right and is on the left"));

  const auto swapped = ReadCar("<left_joint>b_j</left_joint><right_joint>a_j</right_joint>");
  ASSERT_NE(swapped.robot, nullptr) << swapped.messages;
  ASSERT_NE(swapped.robot->drive(), nullptr) << swapped.messages;
  const std::vector<int>& wheels = swapped.robot->actuators.front().joints;
  EXPECT_EQ(swapped.robot->joints[static_cast<std::size_t>(wheels[0])].name, "a_j");
}

TEST(AdoptedDriveTest, AWheelThatIsNamedTwiceIsSaid) {
  const auto [robot, messages] = ReadCar("<left_joint>a_j</left_joint><right_joint>a_j</right_joint>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->drive(), nullptr);
  EXPECT_THAT(messages, HasSubstr("leaves out the wheel at 'a_j': it is named twice"));
  EXPECT_THAT(messages,
              HasSubstr("the differential drive has no module 'motors', since no two of its wheels are "
                        "opposite each other: name two of one radius on one line along y"));
}

TEST(AdoptedDriveTest, OneWrongNameLeavesTheOtherWheels) {
  const auto [robot, messages] =
      ReadCar("<left_joint>none</left_joint><left_joint>a_j</left_joint><right_joint>b_j</right_joint>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NE(robot->drive(), nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("leaves out the wheel at 'none': there is no turning joint of this name"));
}

TEST(AdoptedDriveTest, ADriveWhoseWheelsHaveNoLimitsHasSensibleOnes) {
  std::string car = Wheel("left", 0.1, 0.2) + Wheel("right", 0.1, -0.2);
  for (std::size_t at = 0; (at = car.find("</xyz>", at)) != std::string::npos; at += 6)
    car.insert(at + 6, "<limit><effort>1e16</effort><velocity>1e16</velocity></limit>");
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.15 0 0 0", kSdfBox) + car +
              "<plugin filename=\"libgazebo_ros_diff_drive.so\" name=\"d\"><leftJoint>left_j</leftJoint>"
              "<rightJoint>right_j</rightJoint></plugin>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  EXPECT_NEAR(robot->drive()->max_wheel_speed_rad_s, 40, 1e-9);
  EXPECT_LT(robot->drive()->max_torque_nm, 10);
}

/// A front wheel on a fork that turns about `axis`; `limit` of the fork.
std::string SteeredWheel(const std::string& name, double y, const std::string& axis = "0 0 1") {
  const std::string at = "0.3 " + std::to_string(y) + " 0.05 0 0 0";
  std::string wheel = Wheel(name, 0.3, y);
  wheel.replace(wheel.find("<parent>base"), 12, "<parent>" + name + "_fork");
  return SdfLink(name + "_fork", at, "<box><size>0.01 0.01 0.01</size></box>") + "<joint name=\"" + name +
         "_s\" type=\"revolute\"><parent>base</parent><child>" + name + "_fork</child><axis><xyz>" + axis +
         "</xyz><limit><lower>-0.5</lower><upper>0.6</upper></limit></axis></joint>\n" + wheel;
}
ForeignAnswer ReadAckermann(const std::string& axis) {
  return ReadSdf(
      SdfLink("base", "0 0 0.15 0 0 0", kSdfBox) + SteeredWheel("fl", 0.2, axis) +
      SteeredWheel("fr", -0.2, axis) + Wheel("rl", -0.1, 0.2) + Wheel("rr", -0.1, -0.2) +
      "<plugin filename=\"gz-sim-ackermann-steering-system\" name=\"gz::sim::systems::AckermannSteering\">"
      "<left_joint>fl_j</left_joint><left_joint>rl_j</left_joint><right_joint>fr_j</right_joint>"
      "<right_joint>rr_j</right_joint><left_steering_joint>fl_s</left_steering_joint>"
      "<right_steering_joint>fr_s</right_steering_joint><wheel_base>0.4</wheel_base></plugin>\n");
}

TEST(AdoptedDriveTest, AnAckermannDriveSteersItsFrontWheels) {
  const auto [robot, messages] = ReadAckermann("0 0 1");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  const auto& steering = robot->drive()->steering;
  ASSERT_TRUE(steering) << messages;
  EXPECT_EQ(robot->joints[static_cast<std::size_t>(steering->joints[0])].name, "fl_s");
  EXPECT_NEAR(steering->wheelbase_m, 0.4, 1e-9);
  EXPECT_NEAR(steering->half_track_m, 0.2, 1e-9);
  // From the stop at 0.5 rad of the inner wheel.
  EXPECT_NEAR(steering->max_curvature_1_m, std::tan(0.5) / (0.4 + 0.2 * std::tan(0.5)), 1e-9);
  EXPECT_TRUE(robot->couplings.empty());  // the front wheels roll freely
}

TEST(AdoptedDriveTest, ASteeredWheelWhoseAxisPointsDownCountsTheOtherWay) {
  const auto [robot, messages] = ReadAckermann("0 0 -1");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_TRUE(robot->drive() != nullptr && robot->drive()->steering) << messages;
  const JointModel& joint = robot->joints[static_cast<std::size_t>(robot->drive()->steering->joints[0])];
  EXPECT_EQ(joint.axis_R, Vector3::UnitZ());
  EXPECT_EQ(joint.lower, -0.6);
  EXPECT_EQ(joint.upper, 0.5);
}

TEST(AdoptedDriveTest, AWheelThatDoesNotStandUprightDoesNotSteerAndThatIsSaid) {
  const auto [robot, messages] = ReadAckermann("1 0 0");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  EXPECT_FALSE(robot->drive()->steering);
  EXPECT_THAT(messages,
              HasSubstr("the drive does not steer, since the axis of 'fl_s' does not stand upright"));
}

}  // namespace
}  // namespace coopdyn
