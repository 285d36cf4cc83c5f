// SPDX-License-Identifier: MIT
// Who did what to the run, in the list of events.
#include "server/state/run_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using testing::ElementsAre;

std::vector<std::string> TextsOf(const RunControl& run) {
  std::vector<std::string> texts;
  for (const Event& event : run.events()) texts.push_back(event.text);
  return texts;
}

TEST(RunControl, ADeedNamesWhoDidIt) {
  RunControl run;
  run.AddDeed({0, 0, "info", "reset"}, "Ana");
  EXPECT_THAT(TextsOf(run), ElementsAre("reset by Ana"));
}

TEST(RunControl, ADeedCompletesTheEventThatTellsOfIt) {
  RunControl run;
  run.AddEvent({5, 0.05, "info", "insert BOX_1"});
  run.AddEvent({5, 0.05, "warning", "robot1 has left the floor"});
  run.AddDeed({6, 0.06, "info", "insert BOX_1"}, "Ana");
  EXPECT_THAT(TextsOf(run), ElementsAre("insert BOX_1 by Ana", "robot1 has left the floor"));
}

TEST(RunControl, AProgramThatResetsAgainAndAgainLeavesOneEvent) {
  RunControl run;
  for (int i = 1; i <= 1000; ++i) {
    run.AddDeed({static_cast<std::uint64_t>(i), 0, "info", "pause"}, "learner");
    run.AddDeed({static_cast<std::uint64_t>(i), 0, "info", "reset"}, "learner");
  }
  EXPECT_THAT(TextsOf(run), ElementsAre("pause by learner", "reset by learner"));
  EXPECT_EQ(run.events().back().step, 1000u);
}

}  // namespace
}  // namespace coopdyn
