// SPDX-License-Identifier: MIT
#include "server/base/log.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(PeerLogLimiter, LetsTenLinesASecondThroughPerPeer) {
  PeerLogLimiter limiter;
  std::int64_t suppressed = 0;
  int allowed = 0;
  for (int i = 0; i < 100; ++i) allowed += limiter.Allow("a", i, suppressed) ? 1 : 0;
  EXPECT_EQ(allowed, PeerLogLimiter::kLinesPerSecond);
  EXPECT_TRUE(limiter.Allow("b", 100, suppressed));
}

TEST(PeerLogLimiter, CountsWhatItHeldBack) {
  PeerLogLimiter limiter;
  std::int64_t suppressed = 0;
  for (int i = 0; i < 25; ++i) limiter.Allow("a", 0, suppressed);
  ASSERT_TRUE(limiter.Allow("a", kNanosecondsPerSecond, suppressed));
  EXPECT_EQ(suppressed, 15);
}

}  // namespace
}  // namespace coopdyn
