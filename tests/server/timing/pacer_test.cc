// SPDX-License-Identifier: MIT
#include "server/timing/pace.h"

#include <gtest/gtest.h>

#include "tests/server/timing/milliseconds.h"

namespace coopdyn {
namespace {

TEST(Pacer, FirstStepIsDueOnePeriodAfterTheStart) {
  Pacer pacer;
  pacer.Start(5 * kMs, 10 * kMs, 1);
  EXPECT_EQ(pacer.due(), 15 * kMs);
}

TEST(Pacer, DeadlinesDoNotDriftWhenStepsBeginLate) {
  Pacer pacer;
  pacer.Start(0, 10 * kMs, 1);
  for (int k = 1; k <= 1000; ++k) {
    EXPECT_EQ(pacer.due(), k * 10 * kMs);
    EXPECT_EQ(pacer.Advance(pacer.due() + 3 * kMs), 0);
  }
}

TEST(Pacer, SpeedDividesThePeriod) {
  Pacer pacer;
  pacer.Start(0, 10 * kMs, 4);
  EXPECT_EQ(pacer.due(), 10 * kMs / 4);
  pacer.Start(0, 10 * kMs, 0.5);
  EXPECT_EQ(pacer.due(), 20 * kMs);
}

TEST(Pacer, PeriodsThatDoNotFitWholeNanosecondsAddUpExactly) {
  Pacer pacer;
  pacer.Start(0, 1 * kMs, 3);
  for (int k = 0; k < 2999; ++k) pacer.Advance(pacer.due());
  EXPECT_EQ(pacer.due(), 1000 * kMs);
}

TEST(Pacer, MissedPeriodsAreSkippedAndCountedNotRunInABurst) {
  Pacer pacer;
  pacer.Start(0, 10 * kMs, 1);
  EXPECT_EQ(pacer.Advance(57 * kMs), 4);  // 10 was due; 20, 30, 40, 50 are gone
  EXPECT_EQ(pacer.due(), 60 * kMs);
}

}  // namespace
}  // namespace coopdyn
