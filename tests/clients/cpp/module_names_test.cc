// SPDX-License-Identifier: MIT
// Modules are found by their type: a model may rename them.
#include <gtest/gtest.h>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/made_robot.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

TEST(ModuleNames, MotorsCalledLegsDriveAndACompassCalledNorthIsRead) {
  const MadeRobot made("legs");
  const auto daemon = ServerProcess::Command({"serve", made.scenario()});
  auto sim = connect(daemon.server());
  auto robot = sim.robot("robot1");
  robot.set_velocity(0.2, 0);
  sim.step(20);
  const Reading seen = robot.sense();
  ASSERT_TRUE(seen.pose && seen.wheels && seen.compass);
  EXPECT_GT(seen.pose->x, 0);
  EXPECT_GT(seen.wheels->left_speed, 1);
  EXPECT_EQ(robot.get_wheels().left_speed, seen.wheels->left_speed);
  EXPECT_EQ(robot.get_compass(), *seen.compass);
  EXPECT_EQ(robot.get_compass("north"), *seen.compass);
  EXPECT_EQ(robot.call("motors", "get_wheels").data, robot.call("legs", "get_wheels").data);
  robot.subscribe("motors");
  sim.step();
  EXPECT_EQ(robot.next("motors", 10).step, 21);
  EXPECT_EQ(ErrorOf([&] { robot.get_compass("south"); }).code(), 10);
}

}  // namespace
}  // namespace coopdyn::client
