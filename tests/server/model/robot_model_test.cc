// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;
const std::filesystem::path kCoopbot = std::filesystem::path(COOPDYN_SOURCE_DIR) / "robots/coopbot/model.sdf";

std::string CoopbotText() {
  std::ifstream stream(kCoopbot);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The shipped robot with `from` replaced by `to`, in a file of its own.
class ChangedRobot {
 public:
  ChangedRobot(const std::string& from, const std::string& to) {
    std::string text = CoopbotText();
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    Write(text);
  }
  explicit ChangedRobot(const std::string& text) { Write(text); }
  ~ChangedRobot() { std::filesystem::remove_all(folder_); }

  /// The diagnostics, without the folder's path; empty if the model is good.
  std::string Read() {
    Diagnostics diagnostics;
    const auto model = ReadRobotModel(folder_ / "robot" / "model.sdf", diagnostics);
    EXPECT_EQ(model == nullptr, diagnostics.has_errors());
    std::string text = diagnostics.ToString();
    const std::string prefix = (folder_ / "robot").string() + "/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }

 private:
  void Write(const std::string& text) {
    std::string pattern = (std::filesystem::temp_directory_path() / "coopdyn-model-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    std::filesystem::create_directories(folder_ / "robot");
    std::ofstream(folder_ / "robot" / "model.sdf") << text;
  }
  std::filesystem::path folder_;
};

std::shared_ptr<const RobotModel> Coopbot() {
  Diagnostics diagnostics;
  auto model = ReadRobotModel(kCoopbot, diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return model;
}

TEST(CoopbotTest, LoadsWithoutDiagnostics) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->type, "coopbot");
  ASSERT_EQ(robot->links.size(), 3u);
  EXPECT_EQ(robot->links[0].name, "chassis");
  EXPECT_EQ(robot->joints.size(), 2u);
}

TEST(CoopbotTest, WheelsTouchTheFloorUnderTheAxle) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  EXPECT_DOUBLE_EQ(robot->drive.wheel_radius_m, 0.075);
  EXPECT_DOUBLE_EQ(robot->drive.track_m, 0.28);
  for (const auto& [joint, y] :
       {std::pair(robot->drive.left_joint, 0.14), std::pair(robot->drive.right_joint, -0.14)}) {
    const JointModel& wheel = robot->joints[static_cast<std::size_t>(joint)];
    EXPECT_LT((wheel.p_RJ - Vector3(0, y, 0.075)).norm(), 1e-12);
    EXPECT_LT((wheel.axis_R - Vector3(0, 1, 0)).norm(), 1e-12);
    EXPECT_EQ(wheel.parent, 0);
  }
}

TEST(CoopbotTest, WheelCylindersLieAlongTheAxle) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  const LinkModel& wheel = robot->links[1];
  const Pose X_RG = wheel.X_RL * wheel.collisions.at(0).X_LG;
  EXPECT_NEAR((X_RG.q * Vector3::UnitZ()).y(), 1, 1e-12);
}

TEST(CoopbotTest, ElevenSectorsAdjoinFromRightToLeft) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  ASSERT_EQ(robot->distance_sensors.size(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    const DistanceSensorModel& sensor = robot->distance_sensors[i];
    EXPECT_NEAR(sensor.bearing_rad, (-100 + 20.0 * static_cast<double>(i)) * kDegree, 1e-12);
    EXPECT_NEAR(sensor.opening_rad, 20 * kDegree, 1e-12);
    EXPECT_EQ(sensor.rays, 5);
    EXPECT_EQ(sensor.max_range_m, 4);
  }
}

TEST(CoopbotTest, RangesStartOnTheChassisSurface) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  const LinkShape& body = robot->links[0].collisions.at(0);
  const auto& cylinder = std::get<Cylinder>(body.shape);
  for (const DistanceSensorModel& sensor : robot->distance_sensors) {
    EXPECT_NEAR(sensor.X_RS.p.head<2>().norm(), cylinder.radius_m, 1e-12);
    EXPECT_LT(std::abs(sensor.X_RS.p.z() - body.X_LG.p.z()), cylinder.length_m / 2);
    EXPECT_NEAR(Heading(sensor.X_RS.q), sensor.bearing_rad, 1e-12);
    EXPECT_NEAR(std::atan2(sensor.X_RS.p.y(), sensor.X_RS.p.x()), sensor.bearing_rad, 1e-12);
  }
}

TEST(CoopbotTest, FootprintIsItsChassis) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  EXPECT_NEAR(robot->footprint_radius_m, 0.18, 1e-12);
  EXPECT_NEAR(robot->height_m, 0.26, 1e-12);
}

// With the weight on wheels and casters alike, the wheels carry half of it.
TEST(CoopbotTest, StartsWithoutSlippingOrTipping) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  double mass = 0, moment = 0;
  for (const LinkModel& link : robot->links) {
    mass += link.mass_kg;
    moment += link.mass_kg * (link.X_RL * link.X_LI.p).z();
  }
  const double height = moment / mass;
  const double force = 2 * robot->drive.max_torque_nm / robot->drive.wheel_radius_m;
  const double acceleration = force / mass;
  EXPECT_LT(0.5 / acceleration, 0.3);                   // s to 0.5 m/s
  EXPECT_LT(force, 0.6 * mass * 9.81 / 2);              // traction at mu 1, with room
  EXPECT_LT(acceleration * height, 0.3 * 9.81 * 0.14);  // the load of a caster changes by less than a third
}

TEST(CoopbotTest, HasFourModulesInTheOrderOfPorts) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  std::string names;
  for (const ModuleModel& module : robot->modules) names += module.name + " ";
  EXPECT_EQ(names, "motors distance target pose ");
  EXPECT_TRUE(robot->has_actuators());
}

TEST(CoopbotTest, BodyTakesTheRobotsColour) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  int coloured = 0;
  for (const LinkShape& visual : robot->links[0].visuals) coloured += visual.takes_robot_color ? 1 : 0;
  EXPECT_EQ(coloured, 2);
}

TEST(CoopbotTest, CastersHaveNoFriction) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  int casters = 0;
  for (const LinkShape& collision : robot->links[0].collisions) {
    if (!std::holds_alternative<Sphere>(collision.shape)) continue;
    ++casters;
    EXPECT_EQ(collision.friction, 0);
    EXPECT_NEAR(collision.X_LG.p.z(), std::get<Sphere>(collision.shape).radius_m, 1e-12);
  }
  EXPECT_EQ(casters, 2);
}

}  // namespace
}  // namespace coopdyn
