// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

TEST(SightingTest, BearingsAreLeftPositive) {
  const auto frame = SampleWorld().Robot(At(0, 0)).Mark(2, 2).Mark(0, -3).Mark(5, 0).MakeFrame();
  const auto seen = SeenTargets(*frame, 0);
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[1].index, 1);
  EXPECT_NEAR(seen[0].bearing_rad, std::numbers::pi / 4, 1e-12);
  EXPECT_NEAR(seen[1].bearing_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(seen[2].bearing_rad, 0, 1e-12);
  EXPECT_NEAR(seen[0].distance_m, std::hypot(2, 2), 1e-12);
}

TEST(SightingTest, BearingsAreWrapped) {
  // Heading 170°, target at −170° as seen from the world: 20° to the left.
  const double heading = 170 * std::numbers::pi / 180;
  const auto frame =
      SampleWorld().Robot(At(0, 0, heading)).Mark(std::cos(-heading), std::sin(-heading)).MakeFrame();
  EXPECT_NEAR(SeenTargets(*frame, 0)[0].bearing_rad, 20 * std::numbers::pi / 180, 1e-12);
}

TEST(SightingTest, DistanceIsInThePlaneFromTheAxlesMiddle) {
  const auto frame = SampleWorld().Robot(At(1, 1)).Mark(4, 5, 2.5).MakeFrame();
  EXPECT_NEAR(SeenTargets(*frame, 0)[0].distance_m, 5, 1e-12);
}

TEST(SightingTest, ATargetUnderTheRobotIsAhead) {
  const auto seen = SeenTargets(*SampleWorld().Robot(At(1, 1, 2)).Mark(1, 1).MakeFrame(), 0);
  EXPECT_EQ(seen[0].distance_m, 0);
  EXPECT_EQ(seen[0].bearing_rad, 0);
}

TEST(SightingTest, TargetsOutOfRangeAreLeftOut) {
  auto model = SampleRobot();
  SensorOf<TargetModel>(*model).max_range_m = 3;
  const auto seen = SeenTargets(*SampleWorld().Robot(At(0, 0), model).Mark(4, 0).Mark(2, 0).MakeFrame(), 0);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].index, 1);
}

TEST(SightingTest, WallsHideTargetsOnlyIfTheModelSaysSo) {
  SampleWorld world;
  auto model = SampleRobot();
  SensorOf<TargetModel>(*model).see_through = false;
  world.Robot(At(0, 0), model).Robot(At(0, 3)).Mark(2, 0).Mark(0, -2);
  world.Object(Box{{0.1, 2, 1}}, {{1, 0, 0.5}, Quaternion::Identity()});
  const auto frame = world.MakeFrame();
  const auto seen = SeenTargets(*frame, 0);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].index, 1);
  EXPECT_EQ(SeenTargets(*frame, 1).size(), 2U);  // sees through
}

TEST(SightingTest, OtherRobotsAreSeenAndNotOneself) {
  const auto frame = SampleWorld().Robot(At(0, 0)).Robot(At(1, 0)).Robot(At(0, 2)).MakeFrame();
  const auto seen = SeenRobots(*frame, 1);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].index, 0);
  EXPECT_EQ(seen[1].index, 2);
  EXPECT_NEAR(seen[0].distance_m, 1, 1e-12);
  EXPECT_NEAR(std::abs(seen[0].bearing_rad), std::numbers::pi, 1e-12);
}

TEST(SightingTest, ARobotHidesTheOneBehindItButNotItself) {
  auto model = SampleRobot();
  SensorOf<TargetModel>(*model).see_through = false;
  const auto frame = SampleWorld().Robot(At(0, 0), model).Robot(At(1, 0)).Robot(At(2, 0)).MakeFrame();
  const auto seen = SeenRobots(*frame, 0);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].index, 1);
}

}  // namespace
}  // namespace coopdyn
