// SPDX-License-Identifier: MIT
// Teams of robots of different kinds: joints, several kinds of commands in one step.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"
#include "tests/source_dir.h"

namespace coopdyn::client {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLimit_s = 60;

class TeamJointsTest : public testing::Test {
 protected:
  /// A team of these robots; the others stand still.
  Team Take(const std::vector<std::string>& names) {
    sim_.set_participants(names);
    return sim_.team(names);
  }

  const ServerProcess daemon_ = ServerProcess::Command(
      {"serve", SourceDir() + "/tests/clients/python/kinds.scenario", "--no-http", "--no-render"});
  Simulation sim_ = connect(daemon_.server());
};

TEST_F(TeamJointsTest, WheelsAndArmsOfDifferentRobotsMoveInTheSameSteps) {
  Team team = Take({"wheels1", "arm1", "both1"});
  team.select({"pose", "joints"});
  const TeamReading before = team.read();
  const std::vector<double> bent = {0, 0.8, 0, 0.8, 0, 0.8, 0}, same(6, 0.3);
  TeamReading s;
  for (int k = 0; k < 150; ++k) {
    s = team.step({{"velocities", {{0.2, 0}, {kNan, kNan}, {0.1, 0}}}, {"positions", {{}, bent, same}}},
                  kLimit_s);
  }
  EXPECT_NEAR(s.pose[0][0] - before.pose[0][0], 0.3, 0.02);
  EXPECT_NEAR(s.pose[2][0] - before.pose[2][0], 0.15, 0.02);
  EXPECT_TRUE(std::isnan(s.joints[0][0]));
  const JointReading now = sim_.robot("both1").joints("arm").get();
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(s.joints[2][3 * k], 0.3, 0.01);
    EXPECT_EQ(s.joints[2][3 * k], now.position[k]);
  }
}

TEST_F(TeamJointsTest, GroupsOfOneRobotGetCommandsOfDifferentKindsInOneStep) {
  Team team = Take({"human1"});
  Robot human = sim_.robot("human1");
  const std::vector<std::string> waist = human.joints("waist").get_modes();
  team.step({{"positions/left_arm", {{0.1, 0.2, 0, -0.3}}},
             {"joint_velocities/neck", {{0.2, 0}}},
             {"efforts/right_arm", {{0.5, 0, 0, 0}}}},
            kLimit_s);
  EXPECT_EQ(human.joints("left_arm").get_modes(), std::vector<std::string>(4, "position"));
  EXPECT_EQ(human.joints("neck").get_references(), (std::vector<double>{0.2, 0}));
  EXPECT_EQ(human.joints("right_arm").get_modes(), std::vector<std::string>(4, "effort"));
  EXPECT_EQ(human.joints("waist").get_modes(), waist);
}

TEST_F(TeamJointsTest, WhatDoesNotFitSaysWhatToWrite) {
  Team team = Take({"wheels1", "both1"});
  const std::vector<double> six(6, 0);
  EXPECT_EQ(ErrorOf([&] { team.step({{"position", {six}}}); }).code(), 4);
  EXPECT_EQ(ErrorOf([&] { team.step({{"positions", {six, six, six}}}); }).code(), 3);
  EXPECT_EQ(ErrorOf([&] { team.step({{"positions", {{INFINITY}}}}); }).code(), 4);
  EXPECT_EQ(ErrorOf([&] { team.step({{"positions/leg", {six}}}); }).code(), 10);
  EXPECT_EQ(ErrorOf([&] { team.step({{"positions", {six}}, {"efforts", {six}}}); }).code(), 2);
  EXPECT_EQ(sim_.steps(), 0);
}

}  // namespace
}  // namespace coopdyn::client
