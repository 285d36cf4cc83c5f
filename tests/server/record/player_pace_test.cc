// SPDX-License-Identifier: MIT
#include "server/record/player.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

TEST(PlayPaceTest, TimeRunsFromWhereItWasSet) {
  PlayPace pace;
  pace.Start(5 * kSecond, 100 * kSecond, 1);
  EXPECT_EQ(pace.DueTime(5 * kSecond), 100 * kSecond);
  EXPECT_EQ(pace.DueTime(7 * kSecond), 102 * kSecond);
  EXPECT_EQ(pace.WallTime(102 * kSecond), 7 * kSecond);
}

TEST(PlayPaceTest, TheFactorSpeedsItUp) {
  PlayPace pace;
  pace.Start(0, 0, 64);
  EXPECT_EQ(pace.DueTime(kSecond), 64 * kSecond);
  EXPECT_EQ(pace.WallTime(64 * kSecond), kSecond);
}

TEST(PlayPaceTest, BackwardsTheFrameIsDueNoMoreRightAfterItsTime) {
  PlayPace pace;
  pace.Start(0, 10 * kSecond, -2);
  EXPECT_EQ(pace.DueTime(kSecond), 8 * kSecond);
  EXPECT_LT(pace.DueTime(pace.WallTime(8 * kSecond)), 8 * kSecond);
  EXPECT_GE(pace.DueTime(pace.WallTime(8 * kSecond) - 1), 8 * kSecond);
}

TEST(PlayPaceTest, AFrameIsDueAtItsWallTimeAndNotBefore) {
  for (const double speed : {0.3, 1.0, 1.7, 13.0}) {
    PlayPace pace;
    pace.Start(123, 456, speed);
    for (Nanoseconds time = 456; time < 40'000'000; time += 9'999'991) {
      EXPECT_GE(pace.DueTime(pace.WallTime(time)), time) << speed;
      if (time > 456) {
        EXPECT_LT(pace.DueTime(pace.WallTime(time) - 1), time) << speed;
      }
    }
  }
}

}  // namespace
}  // namespace coopdyn
