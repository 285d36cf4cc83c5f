// SPDX-License-Identifier: MIT
#include "server/timing/overload_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/timing/milliseconds.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A run in real time with steps of 10 ms, judged each second.
class OverloadWatchTest : public ::testing::Test {
 protected:
  /// A second in which `lost` of 100 steps are skipped; the others take `step_ms`, mostly for physics.
  std::string Second(int lost, int step_ms = 2) {
    now_ += 1000 * kMs;
    status_.late_periods += static_cast<std::uint64_t>(lost);
    status_.simulated += (100 - lost) * kDefaultStep;
    status_.load.times.physics += (100 - lost) * (step_ms - 1) * kMs;
    status_.load.times.publish += (100 - lost) * kMs;
    use_.threads[0].cpu += 200 * kMs;
    use_.busy += 200 * kMs;
    for (CpuUser& other : use_.others) {
      other.cpu += others_ms_ * kMs;
      use_.busy += others_ms_ * kMs;
    }
    use_.busy += hidden_ms_ * kMs;
    return watch_.Look(now_, status_);
  }
  /// The first warning within a number of seconds; empty: none.
  std::string Seconds(int seconds, int lost, int step_ms = 2) {
    std::string warning;
    for (int i = 0; i < seconds && warning.empty(); ++i) warning = Second(lost, step_ms);
    return warning;
  }

  RunStatus status_;
  CpuUse use_{{{11, "python3", 0}, {12, "python3", 0}, {13, "python3", 0}}, {{1, "physics", 0}}, 0};
  Nanoseconds others_ms_ = 0, hidden_ms_ = 0, now_ = 5000 * kMs;
  int reads_ = 0;
  OverloadWatch watch_{[this] {
    ++reads_;
    return use_;
  }};
};

TEST_F(OverloadWatchTest, ARunThatKeepsTimeIsNotTalkedAboutNorLookedInto) {
  EXPECT_EQ(Seconds(100, 4), "");
  EXPECT_EQ(reads_, 0);
}

TEST_F(OverloadWatchTest, SaysHowMuchIsLostAndWhatAStepTakes) {
  const std::string warning = Seconds(10, 14, 3);
  EXPECT_THAT(warning, HasSubstr("real time is lost: 14 % in the last 2 s. "));
  EXPECT_THAT(warning, HasSubstr("A step is due every 10 ms and takes 3 ms, most of it physics (2 ms)"));
}

TEST_F(OverloadWatchTest, NamesOtherProgramsByWhatTheyTake) {
  others_ms_ = 530;
  const std::string warning = Seconds(10, 14);
  EXPECT_THAT(warning, HasSubstr("Other programs keep the cores busy: 3 python3 159 %."));
  EXPECT_THAT(warning, HasSubstr("Threads of coopdyn: physics 20 %."));
  EXPECT_THAT(warning, Not(HasSubstr("fewer robots")));
  EXPECT_THAT(warning, Not(HasSubstr("ulimit")));
}

TEST_F(OverloadWatchTest, SaysHowToLetItGoFirstIfItMayNot) {
  others_ms_ = 530;
  status_.load.priority_refused = true;
  EXPECT_THAT(Seconds(10, 14), HasSubstr("`ulimit -e 30` before it starts, or LimitNICE=-10"));
}

TEST_F(OverloadWatchTest, WorkThatProcDoesNotShowIsSaidToo) {
  hidden_ms_ = 900;
  EXPECT_THAT(Seconds(10, 14), HasSubstr("not visible from here keeps the cores busy: 90 %."));
}

TEST_F(OverloadWatchTest, WithNobodyElseTheRunItselfIsTooMuch) {
  const std::string warning = Seconds(10, 40, 16);
  EXPECT_THAT(warning, HasSubstr("takes 16 ms, most of it physics (15 ms)"));
  EXPECT_THAT(warning, HasSubstr("Use fewer robots"));
}

TEST_F(OverloadWatchTest, TheSlowestControllerIsNamedWithItsTime) {
  status_.load.controller = "flock";
  status_.load.controller_step = 12 * kMs;
  EXPECT_THAT(Seconds(10, 40), HasSubstr("of the controllers flock takes most (12 ms)."));
}

TEST_F(OverloadWatchTest, AShortHitchIsNotTalkedAbout) {
  EXPECT_EQ(Seconds(5, 0), "");
  EXPECT_EQ(Seconds(2, 90), "");
  EXPECT_EQ(Seconds(10, 0), "");
}

TEST_F(OverloadWatchTest, ItIsSaidAgainOnlyAfterAMinute) {
  ASSERT_NE(Seconds(10, 14), "");
  const Nanoseconds said = now_;
  ASSERT_NE(Seconds(100, 14), "");
  EXPECT_GE(now_ - said, 60'000 * kMs);
}

TEST_F(OverloadWatchTest, APlaybackThatCountsFromZeroHasLostNothing) {
  EXPECT_EQ(Seconds(3, 14), "");
  status_.late_periods = 0;
  EXPECT_EQ(Seconds(2, 0), "");
}

TEST_F(OverloadWatchTest, OtherModesLoseNothing) {
  status_.mode = Mode::kLockstep;
  EXPECT_EQ(Seconds(10, 50), "");
  status_.mode = Mode::kRealtime;
  status_.speed = 0;  // no limit
  EXPECT_EQ(Seconds(10, 50), "");
}

TEST_F(OverloadWatchTest, AtTwiceTheSpeedAPeriodIsHalfAsLong) {
  status_.speed = 2;
  EXPECT_THAT(Seconds(10, 20), HasSubstr("real time is lost: 10 % in"));
}

}  // namespace
}  // namespace coopdyn
