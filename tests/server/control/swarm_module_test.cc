// SPDX-License-Identifier: MIT
// The members of a team: claimed, released, taken over, removed.
#include "server/control/swarm_module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/server/control/swarm_fixture.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(SwarmModuleTest, ClaimTakesRobotsAndSwarmsAndTellsTheTeamInSceneOrder) {
  const Message one = Ask("claim loner ant_2");
  EXPECT_THAT(one.params, ElementsAre(2, 4));
  EXPECT_EQ(one.text, "ant_2 loner");
  const Message swarm = Ask("claim ant");
  EXPECT_THAT(swarm.params, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(swarm.text, "ant_1 ant_2 ant_3 loner");
  EXPECT_EQ(Ask("get_team").params, swarm.params);
  EXPECT_EQ(StepOf(swarm), 0);
}

TEST_F(SwarmModuleTest, ASwarmIsAlsoCalledByItsSection) {
  EXPECT_THAT(Ask("claim swarm1").params, ElementsAre(1, 2, 3));
}

TEST_F(SwarmModuleTest, ClaimWithoutNamesTakesWhatNobodyDrives) {
  world_.board.Claim(slot("ant_2"), ana_);
  EXPECT_THAT(Ask("claim").params, ElementsAre(1, 3, 4));
}

TEST_F(SwarmModuleTest, ClaimTakesAllOrNoneAndNamesTheOwner) {
  world_.board.Claim(slot("ant_2"), ana_);
  const Message refusal = Ask("claim ant");
  EXPECT_EQ(refusal.error, 6);
  EXPECT_THAT(refusal.text, HasSubstr("ant_2 is driven by ana"));
  EXPECT_THAT(Ask("get_team").params, IsEmpty());
}

TEST_F(SwarmModuleTest, AnUnknownNameIsError10WithWhatMayHaveBeenMeant) {
  const Message refusal = Ask("claim antt");
  EXPECT_EQ(refusal.error, 10);
  EXPECT_THAT(refusal.text, HasSubstr("did you mean ant?"));
  EXPECT_THAT(Ask("claim lonely_hearts_club").text, HasSubstr("ant_1"));
  EXPECT_EQ(Ask("claim " + std::string(100000, 'a')).error, 10);
  EXPECT_LT(client_->received.back().text.size(), 1000u);
}

TEST_F(SwarmModuleTest, ReleaseGivesUpSomeOrAllAndKeepsTheirSetpoints) {
  Ask("claim");
  Ask("step_all wheels 1 1 2 2 3 3 4 4");
  EXPECT_THAT(Ask("release loner ant_1").params, ElementsAre(2, 3));
  EXPECT_EQ(world_.board.Claim(slot("loner"), ana_).error, Error::kOk);
  EXPECT_EQ(Ask("release loner").error, 6);
  const Message none = Ask("release");
  EXPECT_THAT(none.params, IsEmpty());
  EXPECT_EQ(none.text, "");
  world_.Step();
  EXPECT_THAT(LastSetpoints(0), ElementsAre(1, 1));
}

TEST_F(SwarmModuleTest, HelloTakesOverTheTeamOfThatNameAndClosesTheOldConnection) {
  Name("flock");
  Ask("claim ant");
  FakeClient second(*module_, 2);
  second.Ask("hello herd");
  EXPECT_THAT(second.Ask("get_team").params, IsEmpty());
  second.Ask("hello flock");
  EXPECT_THAT(second.Ask("get_team").params, ElementsAre(1, 2, 3));
  EXPECT_EQ(client_->closed_because, "taken over by flock");
}

TEST_F(SwarmModuleTest, TheNextStepTellsWhoWasTakenFromTheTeam) {
  Ask("claim ant");
  world_.board.InputEnded(slot("ant_2"), client_->id());
  world_.board.Closed(slot("ant_2"), client_->id());
  world_.board.Ready(slot("ant_2"), ana_, 3, nobody_);
  world_.board.Ready(slot("loner"), ana_, 3, nobody_);
  EXPECT_THAT(Ask("step_all 0 0 0 0 0 0").text, HasSubstr("no longer in the team: ant_2"));
  EXPECT_EQ(client_->received.back().error, 3);
  const Message reply = Ask("step_all 0 0 9 0");
  EXPECT_EQ(reply.params[1], 2);
  EXPECT_EQ(reply.text, "limited 1 robot; no longer in the team: ant_2");
  EXPECT_EQ(Ask("step_all 0 0 0 0").text, "");
}

TEST_F(SwarmModuleTest, ARobotThatIsMissingAfterALoadIsTold) {
  Ask("claim");
  Load(AntScenario(2));
  EXPECT_EQ(Ask("step_all").text, "no longer in the team: ant_3");
}

TEST_F(SwarmModuleTest, ClosingFreesTheTeam) {
  Ask("claim");
  client_->CloseNow();
  EXPECT_EQ(world_.board.Claim(slot("ant_1"), ana_).error, Error::kOk);
}

TEST_F(SwarmModuleTest, RequestsReadBeforeTheEndOfInputStillRun) {
  Ask("claim");
  client_->EndInput();
  EXPECT_EQ(world_.board.Owners()[0].id, 0u);
  const Message reply = Ask("step_all wheels 1 1 2 2 3 3 4 4");
  EXPECT_EQ(reply.params[1], 4);
  EXPECT_THAT(LastSetpoints(3), ElementsAre(4, 4));
  world_.board.Claim(slot("ant_1"), ana_);
  EXPECT_EQ(Ask("step_all (1) 0 0").error, 6);
}

TEST_F(SwarmModuleTest, StrangersNeedTheTokenOnlyWithPrivate) {
  {
    FakeClient stranger(*module_, 5, false);
    EXPECT_EQ(stranger.Ask("claim ant").error, 0);
  }
  Start(true);
  FakeClient stranger(*module_, 6, false);
  for (const char* line : {"claim", "step_all (1) 0 0", "stop_team", "release", "hello eve"}) {
    EXPECT_EQ(stranger.Ask(line).error, 12) << line;
  }
  EXPECT_EQ(stranger.Ask("read_all 1").error, 0);
  EXPECT_EQ(stranger.Ask("get_team").error, 0);
  EXPECT_EQ(stranger.Ask("hello eve secret").error, 0);
  EXPECT_EQ(stranger.Ask("claim").error, 0);
}

TEST_F(SwarmModuleTest, RobotsThatAControllerDrivesCannotBeClaimed) {
  auto scenario = std::make_shared<Scenario>(*AntScenario(3));
  scenario->robots[1].controller.name = "diffuse";
  Load(scenario);
  const Message refusal = Ask("claim ant");
  EXPECT_EQ(refusal.error, 6);
  EXPECT_THAT(refusal.text, HasSubstr("ant_2 is owned by controller diffuse"));
  EXPECT_THAT(Ask("claim").params, ElementsAre(1, 3, 4));
}

TEST_F(SwarmModuleTest, TheTeamCanBeSubscribedTo) {
  Ask("claim ant_1");
  Ask("subscribe");
  world_.Step();
  thread_.Run();
  ASSERT_EQ(client_->pushes().size(), 1u);
  EXPECT_EQ(client_->pushes()[0].command, -113);
  EXPECT_THAT(client_->pushes()[0].params, ElementsAre(1));
}

TEST_F(SwarmModuleTest, AttachIsForTheModulesOfRobots) {
  EXPECT_EQ(Ask("attach pose").error, 10);
  EXPECT_EQ(Ask("attach").error, 0);
}

TEST_F(SwarmModuleTest, AThousandRoundsWithRobotsThatComeAndGo) {
  Load(AntScenario(20));
  for (int k = 0; k < 1000; ++k) {
    Ask(k % 3 == 0 ? "claim" : "claim ant loner");
    if (k % 5 == 0) Ask("release ant_" + std::to_string(k % 20 + 1));
    if (k % 5 == 0) Ask("claim");
    ASSERT_EQ(Ask("step_all").params[1], 21);
    if (k % 100 == 0) Load(AntScenario(20), StepEnd::kReset);
  }
}

}  // namespace
}  // namespace coopdyn
