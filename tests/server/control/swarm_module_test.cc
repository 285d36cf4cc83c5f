// SPDX-License-Identifier: MIT
// /swarm on the real boards, with steps that run as soon as everybody is ready; no sockets, no physics.
#include "server/control/swarm_module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "server/control/simulation_module.h"
#include "server/devices/device_factory.h"
#include "server/sensing/readings.h"
#include "tests/server/devices/fake_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// ant_1 to ant_`ants` (neighbours within 11 m), then loner with one distance sensor, 10 m apart in y.
std::shared_ptr<Scenario> AntScenario(int ants) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(ants + 1));
  auto ant = std::make_shared<RobotModel>(*SmallModel("ant"));
  ant->neighbours.range_m = 11;
  ant->neighbours.message_range_m = 11;
  ant->modules.push_back({"neighbours", "neighbours"});
  auto loner = std::make_shared<RobotModel>(*SmallModel("loner"));
  loner->distance_sensors.resize(1);
  for (int i = 0; i < ants; ++i) {
    RobotEntry& entry = scenario->robots[static_cast<std::size_t>(i)];
    entry.name = "ant_" + std::to_string(i + 1);
    entry.model = ant;
  }
  scenario->robots.back().name = "loner";
  scenario->robots.back().model = loner;
  SwarmEntry swarm;
  swarm.name = "ant";
  swarm.section = "swarm1";
  swarm.count = static_cast<std::size_t>(ants);
  scenario->swarms.push_back(swarm);
  return scenario;
}

class SwarmModuleTest : public testing::Test {
 protected:
  SwarmModuleTest() {
    Load(AntScenario(3));
    Start(false);
  }
  ~SwarmModuleTest() override {
    client_.reset();
    module_.reset();
  }

  void Load(std::shared_ptr<const Scenario> scenario, StepEnd end = StepEnd::kLoad) {
    world_.Load(std::move(scenario), Mode::kLockstep, end);
  }
  void Start(bool token_required) {
    client_.reset();
    module_.reset();
    guard_.emplace("secret", token_required);
    module_.emplace(SwarmServices{world_.board, world_.frames, roster_, *guard_, clock_, 1, "1.2.3"},
                    thread_.poster());
    client_.emplace(*module_, 1);
    world_.StepInline();
  }

  Message Ask(const std::string& line) { return client_->Ask(line); }
  void Name(const std::string& name) { EXPECT_EQ(Ask("hello " + name).error, 0); }
  std::vector<double> LastSetpoints(int robot) {
    const auto& setpoint = world_.frames.Latest()->robots[static_cast<std::size_t>(robot)].setpoint_rad_s;
    return {setpoint[0], setpoint[1]};
  }
  SlotId slot(const std::string& robot) { return world_.board.FindSlot(robot); }

  SmallWorld world_;
  ManualClock clock_;
  ConnectionRoster roster_;
  std::optional<TokenGuard> guard_;
  FakeThread thread_;
  std::optional<SwarmModule> module_;
  std::optional<FakeClient> client_;
  const Client ana_{100, "ana", "127.0.0.1:100"};
  const StepDone nobody_ = [](const StepResult&) {};
};

// --- claim, release

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

TEST_F(SwarmModuleTest, ANameThatIsBothARobotAndASwarmIsRefused) {
  auto scenario = std::make_shared<Scenario>(*AntScenario(3));
  scenario->robots[3].name = "ant";
  Load(scenario);
  const Message refusal = Ask("claim ant");
  EXPECT_EQ(refusal.error, 10);
  EXPECT_THAT(refusal.text, HasSubstr("both a robot and a swarm"));
  EXPECT_EQ(Ask("claim ant_1").error, 0);
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

// --- step_all

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
  EXPECT_TRUE(client_->is_waiting());  // for loner
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

// --- readings

TEST_F(SwarmModuleTest, DistancesArePaddedToTheRobotWithTheMost) {
  Ask("claim");
  EXPECT_THAT(Ask("select_readings distances").params, ElementsAre(3));
  const Message reply = Ask("read_all");
  EXPECT_THAT(reply.params, ElementsAre(1, 4, 3));
  EXPECT_TRUE(std::isinf(reply.data[0]));
  EXPECT_TRUE(std::isnan(reply.data[9 + 1]));  // loner has one sensor
  EXPECT_TRUE(std::isnan(reply.data[9 + 2]));
  const FramePtr frame = world_.frames.Latest();
  EXPECT_EQ(reply.data[9], Distances(*frame, 3)[0]);
}

TEST_F(SwarmModuleTest, ReadingsAreThoseOfTheRobotsOwnModulesInTheChosenOrder) {
  Ask("claim");
  Ask("step_all wheels 1 2 1 2 1 2 1 2");
  const Message chosen = Ask("select_readings wheels targets pose");
  EXPECT_EQ(chosen.text, "wheels targets pose");
  EXPECT_THAT(chosen.params, ElementsAre(4, 6, 3));
  const Message reply = Ask("read_all 2");
  EXPECT_THAT(reply.params, ElementsAre(1, 1, 13));
  const FramePtr frame = world_.frames.Latest();
  const DeviceFactory factory;
  std::vector<double> expected;
  for (const char* type : {"motors", "target", "pose"}) {
    const auto device = factory.Make({type, type}, frame->scene->robots[1].entry.model);
    device->AppendFirstReading(*frame, 1, expected);
  }
  expected.resize(13);  // of the pose x, y, heading
  EXPECT_EQ(std::vector<double>(reply.data.begin(), reply.data.end() - 2), expected);
}

TEST_F(SwarmModuleTest, TargetsThatAreNotSeenAreInfNan) {
  auto scenario = std::make_shared<Scenario>(*AntScenario(1));
  auto blind = std::make_shared<RobotModel>(*scenario->robots[0].model);
  blind->target_sensor.max_range_m = 3.5;
  scenario->robots[0].model = blind;
  Load(scenario);
  Ask("select_readings targets");
  const Message reply = Ask("read_all 1");
  EXPECT_NEAR(reply.data[0], 3, 1e-12);
  EXPECT_NEAR(reply.data[1], 0, 1e-12);
  EXPECT_TRUE(std::isinf(reply.data[2]));
  EXPECT_TRUE(std::isnan(reply.data[3]));
}

TEST_F(SwarmModuleTest, NeighboursComeNearestFirstTiesByIdAndArePadded) {
  EXPECT_THAT(Ask("select_readings (3) neighbours").params, ElementsAre(9));
  const Message reply = Ask("read_all 2");
  ASSERT_EQ(reply.data.size(), 11u);
  EXPECT_EQ(reply.data[0], 1);  // ant_1 and ant_3 are 10 m away
  EXPECT_NEAR(reply.data[1], 10, 1e-12);
  EXPECT_NEAR(reply.data[2], -M_PI / 2, 1e-12);
  EXPECT_EQ(reply.data[3], 3);
  EXPECT_EQ(reply.data[6], 0);
  EXPECT_TRUE(std::isinf(reply.data[7]));
  EXPECT_TRUE(std::isnan(reply.data[8]));
  Ask("select_readings (1) neighbours");
  EXPECT_EQ(Ask("read_all 2").data[0], 1);
  EXPECT_THAT(Ask("select_readings neighbours").params, ElementsAre(24));
}

TEST_F(SwarmModuleTest, SelectReadingsRefusesUnknownWordsAndTooManyNeighbours) {
  const Message refusal = Ask("select_readings pose distance");
  EXPECT_EQ(refusal.error, 2);
  EXPECT_THAT(refusal.text, HasSubstr("did you mean 'distances'?"));
  EXPECT_EQ(Ask("select_readings pose pose").error, 2);
  EXPECT_EQ(Ask("select_readings (2000000000) neighbours").error, 4);
  EXPECT_THAT(Ask("select_readings").params, ElementsAre(3, 0));
  EXPECT_EQ(client_->received.back().text, "pose distances");
}

TEST_F(SwarmModuleTest, ReadAllReadsAnyRobotAndClaimsNone) {
  world_.board.Claim(slot("ant_1"), ana_);
  const Message reply = Ask("read_all 4 1");
  EXPECT_THAT(reply.params, ElementsAre(1, 2, 6));
  EXPECT_NEAR(reply.data[1], 30, 1e-12);
  EXPECT_THAT(Ask("get_team").params, IsEmpty());
  EXPECT_EQ(Ask("read_all").error, 5);
  EXPECT_EQ(Ask("read_all 1 1").error, 2);
}

TEST_F(SwarmModuleTest, AReplyThatWouldBeTooLargeIsRefusedBeforeAnythingHappens) {
  Load(AntScenario(400));
  Ask("claim ant");
  EXPECT_EQ(Ask("select_readings (10000) neighbours").error, 0);
  EXPECT_EQ(Ask("read_all").error, 8);
  EXPECT_EQ(Ask("step_all").error, 8);
  EXPECT_EQ(Ask("read_all 1 2 3").error, 0);
}

// --- the team and others

TEST_F(SwarmModuleTest, StopTeamStopsAllOfTheTeamAtOnce) {
  Ask("claim ant");
  world_.board.Command(slot("loner"), ana_, {4, 4}, {}, nobody_);
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
  EXPECT_TRUE(client_->is_waiting());  // the second step is for someone to run
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
