// SPDX-License-Identifier: MIT
#include "server/app/run_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/json.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/app/commands.h"
#include "server/model/readers.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A frame of three robots after `steps` of 10 ms.
class RunReportTest : public ::testing::Test {
 protected:
  RunReportTest() {
    RobotLibrary library(SearchPath{{SourceDir()}});
    Diagnostics diagnostics;
    const auto scenario =
        ReadScenario("[SWARM_1]\ntype minibot\ncount 3\n", "ants.scenario", library, false, diagnostics);
    auto frame = std::make_shared<Frame>();
    frame->scene = MakeScene(scenario);
    frame->channels.resize(6);
    frame->bodies.resize(frame->scene->body_ids.size());
    frame->step = 1200;
    frame->time = 1200 * kDefaultStep;
    run_.frame = frame;
    run_.status.real_time_factor = 4;
    run_.status.simulated = frame->time;
    run_.wall_s = 3;
  }
  boost::json::object Json() const { return boost::json::parse(SummaryJson(run_)).as_object(); }

  RunReport run_;
};

TEST_F(RunReportTest, ProgressTellsTheTimeLeft) {
  EXPECT_EQ(ProgressLine(run_), "t = 12.00 s  step 1200  real-time factor 4.00");
  run_.status.duration_s = 60;
  EXPECT_EQ(ProgressLine(run_), "t = 12.00 of 60 s  step 1200  real-time factor 4.00  12 s left");
  run_.status.duration_s = 6012;
  EXPECT_THAT(ProgressLine(run_), HasSubstr("25 min left"));
  run_.status.duration_s = 72012;
  EXPECT_THAT(ProgressLine(run_), HasSubstr("5.0 h left"));
  run_.status.duration_s = 12;
  EXPECT_THAT(ProgressLine(run_), Not(HasSubstr("left")));
}

TEST_F(RunReportTest, NobodyKnowsTheTimeLeftOfARunThatStands) {
  run_.status.real_time_factor = 0;
  run_.status.duration_s = 60;
  EXPECT_THAT(ProgressLine(run_), Not(HasSubstr("left")));
}

TEST_F(RunReportTest, BarIsAsLongAsTheRunIsDone) {
  run_.status.duration_s = 48;
  EXPECT_THAT(ProgressWithBar(run_), HasSubstr("[##########..............................] t = "));
  run_.status.duration_s = 12;
  EXPECT_THAT(ProgressWithBar(run_), HasSubstr("[########################################] "));
}

TEST_F(RunReportTest, SummaryHasStepsRobotsFactorAndHash) {
  EXPECT_EQ(SummaryLine(run_), "1200 steps of 3 robots, t = 12.00 s in 3.00 s, real-time factor 4.00, hash " +
                                   HashText(StateHash(*run_.frame)) + ", nothing frozen");
}

TEST_F(RunReportTest, SummaryNamesWhatWasFrozen) {
  run_.status.frozen = {"swarm1_2", "CRATE"};
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", frozen: swarm1_2, CRATE"));
  run_.status.frozen.assign(25, "x");
  EXPECT_THAT(SummaryLine(run_), HasSubstr("x and 5 more"));
}

TEST_F(RunReportTest, SummaryNamesRobotsWhoseControllerFailed) {
  run_.stopped["swarm1_1"] = {"controller", 7, 0.07, "controller diffuse crashed (abort)"};
  run_.stopped["swarm1_2"] = {"deadline", 8, 0.08, "missed its deadline"};
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", controller failed: swarm1_1"));
  EXPECT_THAT(SummaryLine(run_), Not(HasSubstr("swarm1_2")));
}

TEST_F(RunReportTest, SummarySaysHowMuchRealTimeWasLost) {
  run_.status.late_periods = 132;
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", 132 steps skipped"));
  run_.status.unsolved = 1;
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", 1 substep not solved exactly"));
  run_.status.late_periods = 1;
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", 1 step skipped"));
}

TEST_F(RunReportTest, JsonSaysTheSame) {
  const auto json = Json();
  EXPECT_EQ(json.at("steps").as_int64(), 1200);
  EXPECT_EQ(json.at("robots").as_int64(), 3);
  EXPECT_EQ(json.at("rtf").as_double(), 4);
  EXPECT_EQ(json.at("hash").as_string(), HashText(StateHash(*run_.frame)));
  EXPECT_TRUE(json.at("frozen").as_array().empty());
  EXPECT_TRUE(json.at("stopped").as_array().empty());
  EXPECT_FALSE(json.at("recording_failed").as_bool());
}

TEST_F(RunReportTest, TheFactorIsThatOfWhatWasSimulatedHere) {
  run_.status.simulated = 6 * kNanosecondsPerSecond;  // branched at 6 s
  EXPECT_EQ(Json().at("rtf").as_double(), 2);
}

TEST_F(RunReportTest, JsonSaysHowTheRunEnded) {
  EXPECT_TRUE(Json().at("ended").is_null());
  EXPECT_TRUE(Json().at("duration_s").is_null());
  run_.end = RunEnd::kSignal;
  run_.status.duration_s = 60;
  EXPECT_EQ(Json().at("ended").as_string(), "signal");
  EXPECT_EQ(Json().at("duration_s").as_double(), 60);
}

TEST_F(RunReportTest, JsonSaysWhoWasStoppedWhenAndWhy) {
  run_.stopped["swarm1_1"] = {"controller", 7, 0.07, "controller diffuse crashed (abort)"};
  const auto stopped = Json().at("stopped").as_array();
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped[0].at("robot").as_string(), "swarm1_1");
  EXPECT_EQ(stopped[0].at("by").as_string(), "controller");
  EXPECT_EQ(stopped[0].at("step").as_int64(), 7);
  EXPECT_EQ(stopped[0].at("time_s").as_double(), 0.07);
  EXPECT_EQ(stopped[0].at("why").as_string(), "controller diffuse crashed (abort)");
}

TEST_F(RunReportTest, ARunThatReachedItsDurationIsFine) {
  run_.status.duration_s = 12;
  run_.end = RunEnd::kDuration;
  EXPECT_EQ(ExitCode(run_), kExitOk);
}

TEST_F(RunReportTest, ARunThatEndedBeforeItsDurationIsCutShort) {
  run_.status.duration_s = 12.01;
  for (const RunEnd end : {RunEnd::kSignal, RunEnd::kQuit}) {
    run_.end = end;
    EXPECT_EQ(ExitCode(run_), kExitCutShort);
    EXPECT_THAT(SummaryLine(run_),
                HasSubstr(std::string(", ended early ") + WhyEarly(end) + ", at 12.00 of 12.01 s"));
  }
}

TEST_F(RunReportTest, ARunThatFailedBeforeItsDurationSaysWhat) {
  run_.status.duration_s = 100;
  run_.end = RunEnd::kSignal;
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", ended early by a signal, at 12.00 of 100 s"));
  run_.end = RunEnd::kRecording;
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", ended early because the recording failed, at 12.00 of 100 s"));
  run_.end = RunEnd::kController;
  EXPECT_THAT(SummaryLine(run_), HasSubstr(", ended early because a controller failed, at 12.00 of 100 s"));
}

TEST_F(RunReportTest, WithoutADurationAnyEndIsFine) {
  for (const RunEnd end : {RunEnd::kSignal, RunEnd::kQuit}) {
    run_.end = end;
    EXPECT_EQ(ExitCode(run_), kExitOk);
  }
}

TEST_F(RunReportTest, WhatFailedCountsMoreThanWhatWasCutShort) {
  run_.status.duration_s = 60;
  run_.end = RunEnd::kSignal;
  run_.stopped["swarm1_2"] = {"deadline", 8, 0.08, "missed its deadline"};
  EXPECT_EQ(ExitCode(run_), kExitCutShort);  // a deadline acts as the scenario says
  RunReport frozen = run_, controller = run_, recording = run_;
  frozen.status.frozen_before = {"CRATE"};
  controller.stopped["swarm1_1"] = {"controller", 7, 0.07, "controller diffuse crashed (abort)"};
  recording.recording_failed = true;
  for (const RunReport& run : {frozen, controller, recording}) EXPECT_EQ(ExitCode(run), kExitFaulty);
}

class WriteSummaryTest : public ::testing::Test {
 protected:
  WriteSummaryTest() { std::filesystem::create_directories(folder_); }
  ~WriteSummaryTest() override { std::filesystem::remove_all(folder_); }
  std::string Path(const char* name) const { return (folder_ / name).string(); }
  static std::string Read(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::size_t Files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("summary_" + std::to_string(::getpid()));
};

TEST_F(WriteSummaryTest, ReplacesTheFileAndLeavesNothingElse) {
  EXPECT_EQ(WriteSummary(Path("run.json"), "a long text of before"), "");
  EXPECT_EQ(WriteSummary(Path("run.json"), "new"), "");
  EXPECT_EQ(Read(Path("run.json")), "new");
  EXPECT_EQ(Files(), 1u);
}

TEST_F(WriteSummaryTest, AReaderOfTheFileBeforeHasItWhole) {
  EXPECT_EQ(WriteSummary(Path("run.json"), "before"), "");
  std::ifstream reader(Path("run.json"));
  EXPECT_EQ(WriteSummary(Path("run.json"), "new"), "");
  EXPECT_EQ((std::string{std::istreambuf_iterator<char>(reader), {}}), "before");
}

TEST_F(WriteSummaryTest, ALinkStaysOne) {
  std::filesystem::create_symlink(Path("run.json"), Path("link"));
  EXPECT_EQ(WriteSummary(Path("link"), "text"), "");
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link")));
  EXPECT_EQ(Read(Path("run.json")), "text");
}

TEST_F(WriteSummaryTest, ADeviceIsWrittenTo) {
  EXPECT_EQ(WriteSummary("/dev/null", "text"), "");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(WriteSummaryTest, SaysWhyItCannot) {
  EXPECT_THAT(WriteSummary(Path("none/run.json"), "text"), HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace coopdyn
