// SPDX-License-Identifier: MIT
#include "server/net/polling.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

const Polling::Time kStart{std::chrono::hours(1)};
constexpr microseconds kSpin{50};

/// Is preempted whenever it polls again, `times` times; returns the time of its last poll.
Polling::Time LoseCore(Polling& polling, int times, Polling::Time now) {
  std::int64_t losses = 0;
  for (int i = 0; i < times; ++i) {
    polling.NoteActivity(now);
    while (!polling.Pays(now, kSpin)) polling.NoteActivity(now += milliseconds(1));
    polling.NoteLongPoll(now, ++losses);
  }
  return now;
}

TEST(PollingTest, GoesOnForTheSpinAfterSomethingCame) {
  Polling polling;
  EXPECT_FALSE(polling.Pays(kStart, kSpin));
  polling.NoteActivity(kStart);
  EXPECT_TRUE(polling.Pays(kStart + microseconds(49), kSpin));
  EXPECT_FALSE(polling.Pays(kStart + microseconds(50), kSpin));
}

TEST(PollingTest, PausesOnceTheCoreWasLost) {
  Polling polling;
  LoseCore(polling, 1, kStart);
  const auto before = kStart + Polling::kLeastPause - microseconds(1);
  polling.NoteActivity(before);
  EXPECT_FALSE(polling.Pays(before, kSpin));
  EXPECT_TRUE(polling.Pays(kStart + Polling::kLeastPause, kSpin));
}

TEST(PollingTest, ALongPollThatLostNothingIsWork) {
  Polling polling;
  polling.NoteActivity(kStart);
  polling.NoteLongPoll(kStart, 0);
  EXPECT_TRUE(polling.Pays(kStart, kSpin));
}

TEST(PollingTest, ThePauseGrowsToASecondWhileCoresAreBusy) {
  Polling polling;
  const auto last = LoseCore(polling, 12, kStart);
  EXPECT_EQ(LoseCore(polling, 1, last) - last, Polling::kMostPause);
}

TEST(PollingTest, ThePauseIsShortAgainAfterAQuietTime) {
  Polling polling;
  auto now = LoseCore(polling, 12, kStart) + Polling::kMostPause + milliseconds(300);
  polling.NoteLongPoll(now, 100);
  now += Polling::kLeastPause;
  polling.NoteActivity(now);
  EXPECT_TRUE(polling.Pays(now, kSpin));
}

}  // namespace
}  // namespace coopdyn
