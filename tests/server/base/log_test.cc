// SPDX-License-Identifier: MIT
#include "server/base/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/server/base/temp_folder.h"

namespace coopdyn {
namespace {

using testing::MatchesRegex;

constexpr const char* kWipe = "\r\033\\[K";
// Date, time and zone.
const std::string kWhen = "20[0-9][0-9]-[0-9][0-9]-[0-9][0-9] [0-9:.]+[+-][0-9][0-9]:[0-9][0-9]";

/// A log's output on stderr while `use` writes to it.
template <typename Use>
std::string Written(Use use, const std::string& file = "") {
  testing::internal::CaptureStderr();
  {
    const LogBackend log("info", file);
    use(log.logger());
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Log, ShowsControlCharactersAsQuestionMarks) {
  EXPECT_THAT(Written([](const Logger& logger) { logger->info("{}", "a\nb\033[31m\x7f\té"); }),
              MatchesRegex(kWhen + " info: a\\?b\\?\\[31m\\?\\?é\n"));
}

TEST(Log, WritesALineAboveTheBarAndDrawsTheBarAgain) {
  const std::string bar = "\033\\[\\?7lbar\033\\[\\?7h";
  EXPECT_THAT(Written([](const Logger& logger) {
                ShowBelowLog(logger, "bar");
                logger->info("line");
              }),
              MatchesRegex(bar + kWipe + kWhen + " info: line\n" + bar));
}

TEST(Log, WritesEqualLinesInARowOnceWithTheirCount) {
  EXPECT_THAT(Written([](const Logger& logger) {
                for (int i = 0; i < 13; ++i) logger->warn("no more files");
                logger->info("enough files again");
              }),
              MatchesRegex(kWhen + " warning: no more files\n" + kWhen +
                           " warning: no more files \\(repeated 12 times\\)\n" + kWhen +
                           " info: enough files again\n"));
}

TEST(Log, WritesTheCountOfTheLastLinesAtItsEnd) {
  EXPECT_THAT(Written([](const Logger& logger) {
                for (int i = 0; i < 4; ++i) logger->info("again");
              }),
              MatchesRegex(kWhen + " info: again\n" + kWhen + " info: again \\(repeated 3 times\\)\n"));
}

TEST(Log, LinesThatTakeTurnsAreAllWritten) {
  EXPECT_THAT(Written([](const Logger& logger) {
                for (const char* text : {"came", "went", "came", "went", "went"}) logger->info(text);
              }),
              MatchesRegex(kWhen + " info: came\n" + kWhen + " info: went\n" + kWhen + " info: came\n" +
                           kWhen + " info: went\n" + kWhen + " info: went\n"));
}

TEST(Log, AddsTheSameLinesToAFileButNoBar) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "night.log";
  std::ofstream(file) << "before\n";
  const std::string written = Written(
      [](const Logger& logger) {
        logger->info("one\ttwo");
        logger->info("one\ttwo");
        logger->info("one\ttwo");
      },
      file);
  std::stringstream in_file;
  in_file << std::ifstream(file).rdbuf();
  EXPECT_EQ(in_file.str(), "before\n" + written);
  Written([](const Logger& logger) { ShowBelowLog(logger, "bar"); }, file);
  EXPECT_EQ(std::filesystem::file_size(file), in_file.str().size());
}

TEST(Log, SaysOnceThatItsFileCannotBeWritten) {
  const std::string written = Written(
      [](const Logger& logger) {
        for (int i = 0; i < 5; ++i) logger->info("line {}", i);
      },
      "/dev/full");
  EXPECT_THAT(written, testing::HasSubstr("info: line 4\n"));
  const std::string said = "the log is not complete: ";
  EXPECT_NE(written.find(said), std::string::npos);
  EXPECT_EQ(written.find(said), written.rfind(said));
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
