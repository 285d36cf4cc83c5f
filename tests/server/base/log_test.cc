// SPDX-License-Identifier: MIT
#include "server/base/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/log_bar.h"

namespace coopdyn {
namespace {

using testing::MatchesRegex;

constexpr const char* kWipe = "\r\033\\[K";

/// What a log writes to stderr while `use` has it.
template <typename Use>
std::string Written(Use use) {
  testing::internal::CaptureStderr();
  {
    const LogBackend log("info");
    use(log.logger());
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Log, ShowsControlCharactersAsQuestionMarks) {
  EXPECT_THAT(Written([](const Logger& logger) { logger->info("{}", "a\nb\033[31m\x7f\té"); }),
              MatchesRegex("[0-9:.]+ info: a\\?b\\?\\[31m\\?\\?é\n"));
}

TEST(Log, WritesALineAboveTheBarAndDrawsTheBarAgain) {
  const std::string bar = "\033\\[\\?7lbar\033\\[\\?7h";
  EXPECT_THAT(Written([](const Logger& logger) {
                ShowBelowLog(logger, "bar");
                logger->info("line");
              }),
              MatchesRegex(bar + kWipe + "[0-9:.]+ info: line\n" + bar));
}

TEST(Log, TheNextBarReplacesTheLastAndAnEmptyOneWipesIt) {
  EXPECT_EQ(Written([](const Logger& logger) {
              ShowBelowLog(logger, "1 %");
              ShowBelowLog(logger, "2 %");
              ShowBelowLog(logger, "");
              ShowBelowLog(logger, "");
            }),
            "\033[?7l1 %\033[?7h\r\033[K\033[?7l2 %\033[?7h\r\033[K");
}

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
