// SPDX-License-Identifier: MIT
// The shipped swarm robot keeps its README's promises.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

const RobotModel& Minibot() {
  Diagnostics diagnostics;
  static const auto kModel = ShippedRobots().Get("minibot", {}, diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return *kModel;
}

TEST(MinibotTest, HasTheFootBotsMeasures) {
  const RobotModel& robot = Minibot();
  double mass = 0;
  for (const LinkModel& link : robot.links) mass += link.mass_kg;
  EXPECT_NEAR(mass, 1.6, 1e-12);
  EXPECT_NEAR(robot.footprint_radius_m, 0.085, 1e-9);
  EXPECT_NEAR(robot.drive()->track_m, 0.14, 1e-12);
  EXPECT_NEAR(robot.height_m, 0.12, 1e-12);
  EXPECT_NEAR(robot.drive()->wheel_radius_m * robot.drive()->max_wheel_speed_rad_s, 0.51, 1e-12);
}

TEST(MinibotTest, ProximitySensorsStandAllRoundOnTheChassis) {
  const RobotModel& robot = Minibot();
  const std::vector<SectorModel> sectors = robot.sectors();
  ASSERT_EQ(sectors.size(), 24u);
  for (std::size_t i = 0; i < 24; ++i) {
    const SectorModel& sensor = sectors[i];
    EXPECT_NEAR(sensor.bearing_rad, (-172.5 + 15 * static_cast<double>(i)) * (std::numbers::pi / 180), 1e-12);
    EXPECT_EQ(sensor.rays, 1);
    EXPECT_EQ(sensor.max_range_m, 0.1);
    EXPECT_NEAR(sensor.X_RS.p.head<2>().norm(), 0.085, 1e-12);
  }
}

TEST(MinibotTest, ChassisCoversTheWheels) {
  for (const LinkModel& link : Minibot().links) {
    if (link.name == "chassis") continue;
    const auto& wheel = std::get<Cylinder>(link.collisions.at(0).shape);
    EXPECT_LT(std::hypot(wheel.radius_m, std::abs(link.X_RL.p.y()) + wheel.length_m / 2), 0.085);
  }
}

TEST(MinibotTest, ModulesComeInTheOrderOfPorts) {
  std::string types;
  for (const ModuleModel& module : Minibot().modules()) types += module.type + " ";
  EXPECT_EQ(types, "motors distance target pose neighbours compass ");
  EXPECT_EQ(Minibot().Find<NeighboursModel>()->range_m, 1);
  EXPECT_EQ(Minibot().Find<NeighboursModel>()->message_range_m, 1);
}

// By the README, its motors can neither tip it over nor make its wheels slip.
TEST(MinibotTest, MotorsNeitherTipNorSlip) {
  const RobotModel& robot = Minibot();
  constexpr double kGravity = 9.81, kCaster_m = 0.065;
  double mass = 0, moment = 0, rolling = 0;
  for (const LinkModel& link : robot.links) {
    const double height = (link.X_RL * link.X_LI.p).z();
    mass += link.mass_kg;
    moment += link.mass_kg * height;
    if (link.name != "chassis") rolling += link.inertia_kg_m2.maxCoeff();
  }
  const double radius = robot.drive()->wheel_radius_m;
  const double acceleration =
      2 * robot.drive()->max_torque_nm / radius / (mass + rolling / (radius * radius));
  EXPECT_LT(acceleration, kCaster_m / (moment / mass) * kGravity / 4);
  EXPECT_LT(mass * acceleration, 0.7 * mass * kGravity / 2);
}

}  // namespace
}  // namespace coopdyn
