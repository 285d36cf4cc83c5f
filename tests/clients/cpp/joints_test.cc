// SPDX-License-Identifier: MIT
// Arms: the same program in lockstep and in real time, a robot with several actuators, refused commands.
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

class JointsTest : public testing::Test {
 protected:
  void Move(const std::vector<double>& q, const WhichJoints& joints = {}) {
    arm_.set_positions(q, joints);
    EXPECT_FALSE(arm_.arrived()) << "no step has run yet";
    for (int k = 0; k < 3000 && !arm_.arrived(); ++k) sim_.step();
    EXPECT_TRUE(arm_.arrived());
  }

  const ServerProcess daemon_ =
      ServerProcess::Command({"serve", SourceDir() + "/tests/clients/python/arms.scenario"});
  Simulation sim_ = connect(daemon_.server());
  Robot robot_ = sim_.robot("arm1");
  Robot mobile_ = sim_.robot("m1");
  Joints arm_ = robot_.joints();
  const std::vector<double> bent_ = {0, 0.8, 0, 0.8, 0, 0.8, 0};
};

TEST_F(JointsTest, PositionsAreReachedInBothModes) {
  Move(bent_);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(arm_.get().position[i], bent_[i], 1e-3);
  sim_.set_mode("realtime");
  Move({0.3}, arm_.names()[2]);
  EXPECT_NEAR(arm_.get(3).position[0], 0.3, 1e-3);
}

TEST_F(JointsTest, TheToolGoesWhereInverseSays) {
  Move(bent_);
  Eigen::Isometry3d pose = arm_.forward();
  pose.translation().z() += 0.1;
  Move(arm_.inverse(pose));
  EXPECT_LT((arm_.forward().matrix() - pose.matrix()).norm(), 1e-3);
}

TEST_F(JointsTest, CommandsOfOneKindGoTogetherWithAStepAndTwoKindsAreRefused) {
  arm_.set_velocities({0.1}, 1);
  arm_.set_velocities({0.3, 0.2}, {"joint_1", "joint_2"});
  EXPECT_EQ(ErrorOf([&] { arm_.set_positions({0.1}, 3); }).code(), 5);
  sim_.step();
  EXPECT_EQ(arm_.get_references({1, 2}), (std::vector<double>{0.3, 0.2}));
  EXPECT_EQ(arm_.get_modes({1, 2}), (std::vector<std::string>{"velocity", "velocity"}));
  arm_.hold();
  sim_.step(5);
  EXPECT_EQ(arm_.get_modes(), std::vector<std::string>(7, "position"));
}

TEST_F(JointsTest, HowJointsAreDrivenIsSetAndRead) {
  arm_.set_profile({0.5}, {2}, 1);
  EXPECT_EQ(arm_.get_profile(1).speed, std::vector<double>{0.5});
  arm_.set_compliance({50}, {2}, {0}, {1, 2});
  EXPECT_EQ(arm_.get_compliance({2, 3}).k,
            (std::vector<double>{50, std::numeric_limits<double>::infinity()}));
}

TEST_F(JointsTest, WheelsAndAnArmStepTogether) {
  Joints arm = mobile_.joints("arm");
  const double x = mobile_.get_pose().x;
  mobile_.set_velocity(0.2, 0);
  arm.set_velocities({0.1}, 1);
  sim_.step(50);
  const Reading seen = mobile_.sense();
  EXPECT_EQ(seen.step, 50);
  EXPECT_GT(seen.pose->x, x + 0.05);
  EXPECT_GT(seen.joints.at("arm").position[0], 0.04);
}

TEST_F(JointsTest, WrongNamesAndCountsSayWhatToWrite) {
  EXPECT_EQ(ErrorOf([&] { arm_.set_positions({1}, "elbow"); }).code(), 10);
  EXPECT_EQ(ErrorOf([&] { arm_.set_positions({1}, 8); }).code(), 4);
  EXPECT_EQ(ErrorOf([&] { arm_.set_positions({1, 2}); }).code(), 3);
  EXPECT_EQ(ErrorOf([&] { arm_.set_modes({"fast"}); }).code(), 4);
  EXPECT_EQ(ErrorOf([&] { robot_.joints("leg"); }).code(), 10);
  EXPECT_EQ(ErrorOf([&] { robot_.set_velocity(1, 0); }).code(), 5);
}

}  // namespace
}  // namespace coopdyn::client
