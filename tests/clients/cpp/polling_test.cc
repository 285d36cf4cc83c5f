// SPDX-License-Identifier: MIT
#include "clients/cpp/polling.h"

#include <gtest/gtest.h>

namespace coopdyn::client {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

class ClientPollingTest : public ::testing::Test {
 protected:
  ClientPollingTest() { polling_.set_spin(50e-6); }

  /// A wait that is preempted for 4 ms.
  void LoseCore() {
    polling_.Start(now_);
    polling_.ShouldPollAgain(now_ += milliseconds(4));
  }
  bool Polls() {
    polling_.Start(now_);
    return polling_.ShouldPollAgain(now_);
  }

  Polling polling_;
  Deadline now_{std::chrono::hours(1)};
};

TEST_F(ClientPollingTest, GoesOnForTheSpin) {
  polling_.Start(now_);
  EXPECT_TRUE(polling_.ShouldPollAgain(now_ + microseconds(30)));
  EXPECT_TRUE(polling_.ShouldPollAgain(now_ + microseconds(49)));
  EXPECT_FALSE(polling_.ShouldPollAgain(now_ + microseconds(50)));
}

TEST_F(ClientPollingTest, PausesOnceTheCoreWasLost) {
  LoseCore();
  EXPECT_FALSE(Polls());
  now_ += milliseconds(10);
  EXPECT_TRUE(Polls());
}

TEST_F(ClientPollingTest, AWaitLongerThanTheSpinIsNoLoss) {
  polling_.Start(now_);
  while (polling_.ShouldPollAgain(now_)) now_ += microseconds(10);
  polling_.ShouldPollAgain(now_ += seconds(3));  // it slept until the reply came
  EXPECT_TRUE(Polls());
}

TEST_F(ClientPollingTest, ThePauseGrowsToASecondAndIsShortAgainAfterAQuietTime) {
  for (int i = 0; i < 12; ++i) {
    LoseCore();
    while (!Polls()) now_ += milliseconds(1);
  }
  LoseCore();
  now_ += milliseconds(990);
  EXPECT_FALSE(Polls());
  now_ += milliseconds(500);
  LoseCore();
  now_ += milliseconds(10);
  EXPECT_TRUE(Polls());
}

}  // namespace
}  // namespace coopdyn::client
