// SPDX-License-Identifier: MIT
// Driving a team: step_all, stop_team, ready.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/control/swarm_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(SwarmModuleTest, StepAllDrivesTheTeamAndAnswersAfterTheStepWithTheReadings) {
  Ask("claim");
  const Message reply = Ask("step_all 0.2 0 0.1 0.5 0 0 -0.1 0");
  EXPECT_EQ(reply.error, 0);
  EXPECT_THAT(reply.params, ElementsAre(1, 4, 6));  // lockstep; pose and three sensors
  ASSERT_EQ(reply.data.size(), 4u * 6 + 2);
  EXPECT_EQ(StepOf(reply), 1);
  EXPECT_EQ(reply.text, "");
  EXPECT_THAT(LastSetpoints(0), ElementsAre(0.2 / 0.1, 0.2 / 0.1));
  EXPECT_THAT(LastSetpoints(1), ElementsAre((0.1 - 0.1) / 0.1, (0.1 + 0.1) / 0.1));
  EXPECT_THAT(LastSetpoints(3), ElementsAre(-1, -1));
  EXPECT_NEAR(reply.data[0], 0.01, 1e-12);
  EXPECT_NEAR(reply.data[6 + 1], 10, 1e-12);
}

TEST_F(SwarmModuleTest, RowsComeInTheOrderOfTheRequest) {
  Ask("claim");
  const Message reply = Ask("step_all (3 1) wheels 3 3 1 1");
  EXPECT_EQ(reply.params[1], 2);
  EXPECT_NEAR(reply.data[1], 20, 1e-12);
  EXPECT_NEAR(reply.data[6 + 1], 0, 1e-12);
  EXPECT_THAT(LastSetpoints(2), ElementsAre(3, 3));
  EXPECT_THAT(LastSetpoints(0), ElementsAre(1, 1));
}

TEST_F(SwarmModuleTest, OwnedRobotsThatAreNotNamedKeepTheirSetpointsAndCountAsReady) {
  Ask("claim");
  Ask("step_all wheels 1 1 2 2 3 3 4 4");
  const Message reply = Ask("step_all (2) wheels 9 9");
  EXPECT_EQ(StepOf(reply), 2);
  EXPECT_THAT(LastSetpoints(0), ElementsAre(1, 1));
  EXPECT_THAT(LastSetpoints(1), ElementsAre(9, 9));
}

TEST_F(SwarmModuleTest, WithoutDataSetpointsAreKept) {
  Ask("claim");
  Ask("step_all wheels 1 1 2 2 3 3 4 4");
  EXPECT_EQ(StepOf(Ask("step_all")), 2);
  EXPECT_THAT(LastSetpoints(3), ElementsAre(4, 4));
}

TEST_F(SwarmModuleTest, ANamedRobotThatNobodyOwnsIsClaimed) {
  client_->Send("step_all (2) 0.1 0");
  EXPECT_TRUE(client_->is_waiting());  // the others have no client
  EXPECT_EQ(world_.board.Claim(slot("ant_2"), ana_).error, Error::kOwned);
  world_.Step();
  thread_.Run();
  EXPECT_THAT(client_->received.back().params, ElementsAre(1, 1, 6));
  EXPECT_THAT(Ask("get_team").params, ElementsAre(2));
}

TEST_F(SwarmModuleTest, OneOfSomebodyElseRefusesAllAndNothingHappens) {
  world_.board.Claim(slot("ant_3"), ana_);
  Ask("claim ant_1");
  const Message refusal = Ask("step_all (1 2 3) 0.1 0 0.1 0 0.1 0");
  EXPECT_EQ(refusal.error, 6);
  EXPECT_THAT(refusal.text, HasSubstr("ant_3 is driven by ana"));
  EXPECT_THAT(Ask("get_team").params, ElementsAre(1));
  EXPECT_THAT(LastSetpoints(0), ElementsAre(0, 0));
  EXPECT_EQ(world_.frames.Latest()->step, 0u);
}

TEST_F(SwarmModuleTest, WrongRequestsChangeNothingAndSayWhatToWrite) {
  Ask("claim");
  EXPECT_THAT(Ask("step_all (1 1) 0 0 0 0").text, HasSubstr("robot 1 is named twice"));
  EXPECT_EQ(client_->received.back().error, 2);
  EXPECT_EQ(Ask("step_all (9) 0 0").error, 10);
  EXPECT_THAT(client_->received.back().text, HasSubstr("ids are 1 to 4"));
  EXPECT_EQ(Ask("step_all 0 0").error, 3);
  EXPECT_THAT(client_->received.back().text, HasSubstr("2 data for each of 4 robots"));
  EXPECT_EQ(Ask("step_all wheel 0 0 0 0 0 0 0 0").error, 2);
  EXPECT_THAT(client_->received.back().text, HasSubstr("did you mean 'wheels'?"));
  const auto nan = std::nan("");
  client_->SendMessage(
      {.error = 0, .text = "", .command = 110, .params = {}, .data = {0, 0, 0, 0, 0, 0, 0, nan}});
  EXPECT_EQ(client_->received.back().error, 4);
  client_->SendMessage({.error = 0, .text = "", .command = 110, .params = {-1}, .data = {}});
  EXPECT_EQ(client_->received.back().error, 4);
  client_->SendMessage({.error = 0, .text = "", .command = 110, .params = {}, .data = {1}});
  EXPECT_EQ(client_->received.back().error, 3);
  EXPECT_EQ(world_.frames.Latest()->step, 0u);
}

TEST_F(SwarmModuleTest, SpeedsBeyondTheLimitsAreScaledAsByTheMotorsAndCounted) {
  Ask("claim");
  EXPECT_EQ(Ask("step_all 9 0 0.1 0 9 9 0 0").text, "limited 2 robots");
  EXPECT_THAT(LastSetpoints(0), ElementsAre(10, 10));
  EXPECT_EQ(Ask("step_all (1) wheels 20 10").text, "limited 1 robot");
  EXPECT_THAT(LastSetpoints(0), ElementsAre(10, 5));
}

TEST_F(SwarmModuleTest, WithoutRobotsStepAllSaysWhatToDo) {
  const Message refusal = Ask("step_all");
  EXPECT_EQ(refusal.error, 5);
  EXPECT_THAT(refusal.text, HasSubstr("claim"));
}

TEST_F(SwarmModuleTest, StepAllIsAnsweredAfterTheStepInEveryMode) {
  for (const Mode mode : {Mode::kRealtime, Mode::kFree}) {
    world_.board.SetMode(mode, 0);
    Ask("claim");
    client_->Send("step_all 0.1 0 0.1 0 0.1 0 0.1 0");
    EXPECT_TRUE(client_->is_waiting());
    world_.Step();
    thread_.Run();
    EXPECT_FALSE(client_->is_waiting());
    EXPECT_EQ(client_->received.back().params[0], static_cast<int>(mode));
  }
}

TEST_F(SwarmModuleTest, ResetAndLoadEndTheWaitWithError5) {
  Ask("claim ant");
  client_->Send("step_all");
  EXPECT_TRUE(client_->is_waiting());  // waits for loner
  Load(AntScenario(3), StepEnd::kReset);
  thread_.Run();
  EXPECT_EQ(client_->received.back().error, 5);
  EXPECT_EQ(client_->received.back().text, "reset");
  EXPECT_THAT(Ask("get_team").params, ElementsAre(1, 2, 3));
  client_->Send("step_all");
  Load(AntScenario(2));
  thread_.Run();
  EXPECT_EQ(client_->received.back().text, "load");
  EXPECT_EQ(Ask("get_team").text, "ant_1 ant_2");
}

TEST_F(SwarmModuleTest, StopTeamStopsAllOfTheTeamAtOnce) {
  Ask("claim ant");
  world_.board.Command(slot("loner"), ana_, Wheels(4, 4), {}, nobody_);
  Ask("step_all wheels 1 1 2 2 3 3");
  EXPECT_EQ(Ask("stop_team").error, 0);
  world_.Step();
  EXPECT_THAT(LastSetpoints(1), ElementsAre(0, 0));
  EXPECT_THAT(LastSetpoints(3), ElementsAre(4, 4));
}

TEST_F(SwarmModuleTest, ReadyKeepsTheSetpointsForSomeSteps) {
  Ask("claim");
  Ask("step_all wheels 1 1 2 2 3 3 4 4");
  client_->Send("ready 2");
  thread_.Run();
  EXPECT_TRUE(client_->is_waiting());  // another client must run the second step
  world_.Step();
  thread_.Run();
  EXPECT_FALSE(client_->is_waiting());
  EXPECT_THAT(client_->received.back().params, ElementsAre(1));
  EXPECT_EQ(StepOf(client_->received.back()), 3);
  EXPECT_THAT(LastSetpoints(3), ElementsAre(4, 4));
}

TEST_F(SwarmModuleTest, ReadyWithoutRobotsWaitsAndMakesNobodyReady) {
  client_->Send("ready");
  EXPECT_TRUE(client_->is_waiting());
  EXPECT_FALSE(world_.board.AllReady());
  world_.Step();
  thread_.Run();
  EXPECT_FALSE(client_->is_waiting());
}

}  // namespace
}  // namespace coopdyn
