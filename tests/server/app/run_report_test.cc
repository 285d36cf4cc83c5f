// SPDX-License-Identifier: MIT
#include "server/app/run_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>

#include "server/model/readers.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A frame of three robots after `steps` of 10 ms.
class RunReportTest : public ::testing::Test {
 protected:
  RunReportTest() {
    RobotLibrary library(SearchPath{{COOPDYN_SOURCE_DIR}});
    Diagnostics diagnostics;
    const auto scenario =
        ReadScenario("[SWARM_1]\ntype minibot\ncount 3\n", "ants.scenario", library, false, diagnostics);
    frame_.scene = MakeScene(scenario);
    frame_.robots.resize(3);
    frame_.bodies.resize(frame_.scene->body_ids.size());
    frame_.step = 1200;
    frame_.time = 1200 * kDefaultStep;
    status_.real_time_factor = 4;
  }

  Frame frame_;
  RunStatus status_;
};

TEST_F(RunReportTest, ProgressTellsTheTimeLeft) {
  EXPECT_EQ(ProgressLine(frame_, status_, 0), "t = 12.00 s  step 1200  real-time factor 4.00");
  EXPECT_EQ(ProgressLine(frame_, status_, 60),
            "t = 12.00 of 60 s  step 1200  real-time factor 4.00  12 s left");
  EXPECT_THAT(ProgressLine(frame_, status_, 6012), HasSubstr("25 min left"));
  EXPECT_THAT(ProgressLine(frame_, status_, 72012), HasSubstr("5.0 h left"));
  EXPECT_THAT(ProgressLine(frame_, status_, 12), Not(HasSubstr("left")));
}

TEST_F(RunReportTest, NobodyKnowsTheTimeLeftOfARunThatStands) {
  status_.real_time_factor = 0;
  EXPECT_THAT(ProgressLine(frame_, status_, 60), Not(HasSubstr("left")));
}

TEST_F(RunReportTest, BarIsAsLongAsTheRunIsDone) {
  EXPECT_THAT(ProgressWithBar(frame_, status_, 48),
              HasSubstr("[##########..............................] t = "));
  EXPECT_THAT(ProgressWithBar(frame_, status_, 12), HasSubstr("[########################################] "));
}

TEST_F(RunReportTest, SummaryHasStepsRobotsFactorAndHash) {
  EXPECT_EQ(SummaryLine(frame_, status_, 3),
            "1200 steps of 3 robots, t = 12.00 s in 3.00 s, real-time factor 4.00, hash " +
                HashText(StateHash(frame_)) + ", nothing frozen");
}

TEST_F(RunReportTest, SummaryNamesWhatWasFrozen) {
  status_.frozen = {"swarm1_2", "CRATE"};
  EXPECT_THAT(SummaryLine(frame_, status_, 3), HasSubstr(", frozen: swarm1_2, CRATE"));
  status_.frozen.assign(25, "x");
  EXPECT_THAT(SummaryLine(frame_, status_, 3), HasSubstr("x and 5 more"));
}

TEST_F(RunReportTest, JsonSaysTheSame) {
  const auto json = boost::json::parse(SummaryJson(frame_, status_, 3)).as_object();
  EXPECT_EQ(json.at("steps").as_int64(), 1200);
  EXPECT_EQ(json.at("robots").as_int64(), 3);
  EXPECT_EQ(json.at("rtf").as_double(), 4);
  EXPECT_EQ(json.at("hash").as_string(), HashText(StateHash(frame_)));
  EXPECT_TRUE(json.at("frozen").as_array().empty());
}

}  // namespace
}  // namespace coopdyn
