// SPDX-License-Identifier: MIT
// The commands of /simulation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/control/simulation_fixture.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(SimulationModuleTest, EditsReachTheSteppingThreadAndAreAnsweredAfterIt) {
  client_->Send("run");
  EXPECT_TRUE(client_->is_waiting());
  ApplyEdits();
  EXPECT_THAT(client_->received.at(0).data, ElementsAre(0, 0));
  Ask("pause");
  EXPECT_NO_THROW(LastEdit<edit::Pause>());
  Ask("set_mode free");
  EXPECT_EQ(LastEdit<edit::SetMode>().mode, Mode::kFree);
  Ask("set_step 0.0123");
  EXPECT_EQ(LastEdit<edit::SetStep>().step, 12'300'000);
  Ask("set_speed -1");
  EXPECT_EQ(LastEdit<edit::SetSpeed>().factor, -1);
  Ask("stop_all");
  EXPECT_NO_THROW(LastEdit<edit::StopAll>());
}

TEST_F(SimulationModuleTest, StepRangeIsToldWithTheReason) {
  for (const char* line : {"set_step 0.00049", "set_step 0.11", "set_step 0", "set_step -0.01"}) {
    const Message reply = Ask(line);
    EXPECT_EQ(reply.error, 4) << line;
    EXPECT_THAT(reply.text, HasSubstr("0.0005 to 0.1"));
  }
  EXPECT_THAT(Ask("set_step 0.0033333").text, HasSubstr("set_step 0.003333"));
  EXPECT_EQ(Ask("set_step 0.0005").error, 0);
  EXPECT_EQ(LastEdit<edit::SetStep>().step, kMinStep);
  EXPECT_EQ(Ask("set_step 0.1").error, 0);
  EXPECT_EQ(LastEdit<edit::SetStep>().step, kMaxStep);
}

TEST_F(SimulationModuleTest, ResetTakesASeedAndReportsTheNewFrame) {
  world_.Step();
  EXPECT_EQ(StepOf(Ask("reset 7")), 0);
  EXPECT_EQ(LastEdit<edit::Reset>().seed, 7u);
  EXPECT_THAT(applied_scenes_, ElementsAre("small"));
  Ask("reset");
  EXPECT_FALSE(LastEdit<edit::Reset>().seed);
  Message negative;
  negative.command = command::kReset;
  negative.params = {-1};
  client_->SendMessage(negative);
  EXPECT_EQ(client_->received.back().error, 4);
}

TEST_F(SimulationModuleTest, StepIsAnsweredAfterTheLastOfItsSteps) {
  client_->Send("step 2");
  ApplyEdits();
  world_.Step();
  thread_.Run();
  EXPECT_TRUE(client_->is_waiting());
  world_.Step();
  thread_.Run();
  EXPECT_THAT(client_->received.at(0).data, ElementsAre(0.02, 2));
}

TEST_F(SimulationModuleTest, RefusedStepIsAnsweredWithTheReason) {
  next_result_ = {Error::kNotPossible, "send pause first", nullptr};
  const Message reply = Ask("step 2");
  EXPECT_EQ(reply.error, 5);
  EXPECT_EQ(reply.text, "send pause first");
}

TEST_F(SimulationModuleTest, WaitingStepEndsWithAResetByAnother) {
  FakeClient other(*module_, 2);
  client_->Send("step 2");
  ApplyEdits();
  other.Send("reset");
  ApplyEdits();
  EXPECT_EQ(client_->received.at(0).error, 5);
  EXPECT_EQ(client_->received.at(0).text, "reset");
  EXPECT_EQ(other.received.at(0).error, 0);
}

TEST_F(SimulationModuleTest, ReadyWaitsForStepsAndTellsTheMode) {
  client_->Send("ready");
  world_.Step();
  thread_.Run();
  EXPECT_THAT(client_->received.at(0).params, ElementsAre(1));
  EXPECT_THAT(client_->received.at(0).data, ElementsAre(0.01, 1));
}

TEST_F(SimulationModuleTest, ScenarioIsLoadedByNameAndRobotsFollowBeforeTheReply) {
  const Message reply = Ask("load_scenario hall");
  EXPECT_EQ(reply.error, 0) << reply.text;
  EXPECT_THAT(applied_scenes_, ElementsAre("hall"));
  EXPECT_EQ(Status()["scenario"], "hall");
}

TEST_F(SimulationModuleTest, OthersAreAnsweredWhileRobotsComeAndTheLoadWhenAllServe) {
  serve_at_once_ = false;
  client_->Send("load_scenario hall");
  RunLoads();
  ApplyEdits();
  EXPECT_TRUE(client_->received.empty());
  FakeClient other(*module_, 2);
  other.Send("get_time");
  EXPECT_EQ(other.received.at(0).error, 0);
  serve_();
  thread_.Run();
  EXPECT_EQ(client_->received.at(0).error, 0);
}

TEST_F(SimulationModuleTest, ScenarioIsLoadedFromItsText) {
  Message request;
  request.command = command::kLoadScenario;
  request.text = "[FLOOR]\nsize 6 6 0.1\n";
  client_->SendMessage(request);
  RunLoads();
  ApplyEdits();
  EXPECT_EQ(client_->received.back().error, 0) << client_->received.back().text;
  EXPECT_EQ(LastEdit<edit::Load>().scenario->floor.length_m, 6);
}

TEST_F(SimulationModuleTest, LoadThatFailsTellsWhyAndChangesNothing) {
  const Message unknown = Ask("load_scenario hal");
  EXPECT_EQ(unknown.error, 10);
  EXPECT_THAT(unknown.text, HasSubstr("hall"));
  const Message broken = Ask("load_scenario broken");
  EXPECT_EQ(broken.error, 7);
  EXPECT_THAT(broken.text, HasSubstr("broken.scenario:2: error: "));
  for (const char* path :
       {"load_scenario ../hall", "load_scenario /etc/passwd", "load_scenario ..\\\\hall"}) {
    EXPECT_EQ(Ask(path).error, 10) << path;
  }
  EXPECT_TRUE(applied_.empty());
  next_result_ = {Error::kMalformed, "hall.scenario:3: error: BOX_1 starts inside robot1", nullptr};
  EXPECT_THAT(Ask("load_scenario hall").text, HasSubstr("BOX_1"));
  EXPECT_TRUE(applied_scenes_.empty());
}

TEST_F(SimulationModuleTest, ReloadReadsTheFileAgain) {
  EXPECT_EQ(Ask("reload").error, 5) << "the first one came from nowhere";
  Ask("load_scenario hall");
  Write("hall.scenario", "[FLOOR]\nsize 5 5 0.1\n");
  EXPECT_EQ(Ask("reload").error, 0);
  EXPECT_EQ(LastEdit<edit::Load>().scenario->floor.length_m, 5);
}

TEST_F(SimulationModuleTest, OthersAreAnsweredWhileAScenarioIsRead) {
  client_->Send("load_scenario hall");
  FakeClient other(*module_, 2);
  EXPECT_EQ(other.Ask("get_status").error, 0);
  EXPECT_TRUE(client_->is_waiting());
  RunLoads();
  ApplyEdits();
  EXPECT_FALSE(client_->is_waiting());
  EXPECT_THAT(applied_scenes_, ElementsAre("hall"));
}

TEST_F(SimulationModuleTest, ASecondLoadIsReadWhenTheFirstIsInForce) {
  Write("yard.scenario", "[FLOOR]\nsize 9 9 0.1\n");
  FakeClient other(*module_, 2);
  client_->Send("load_scenario yard");
  other.Send("reload");  // reloads the yard, by then
  RunLoads();
  EXPECT_TRUE(loads_.empty()) << "the first is read, but not in force";
  ApplyEdits();
  EXPECT_FALSE(client_->is_waiting());
  EXPECT_EQ(loads_.size(), 1u);
  RunLoads();
  ApplyEdits();
  EXPECT_EQ(other.received.back().error, 0) << other.received.back().text;
  EXPECT_THAT(applied_scenes_, ElementsAre("yard", "yard"));
}

TEST_F(SimulationModuleTest, ALoadWhoseClientHasGoneHoldsNobodyUp) {
  {
    FakeClient gone(*module_, 2);
    gone.Send("load_scenario broken");
  }
  client_->Send("load_scenario hall");
  while (!loads_.empty()) {
    RunLoads();
    ApplyEdits();
  }
  EXPECT_EQ(client_->received.back().error, 0) << client_->received.back().text;
}

TEST_F(SimulationModuleTest, FilesThatAreNoScenariosAreNotRead) {
  Write(".env", "TOKEN=secret\n");
  Write("notes", "secret\n");
  for (const char* name : {"C:.env", "c:notes", "notes", ".env", "notes\x1b"}) {
    Message request;
    request.command = command::kLoadScenario;
    request.text = name;
    client_->SendMessage(request);
    RunLoads();
    ApplyEdits();
    const Message& reply = client_->received.back();
    EXPECT_EQ(reply.error, 10) << name;
    EXPECT_EQ(reply.text.find("secret"), std::string::npos) << reply.text;
    EXPECT_EQ(reply.text.find('\x1b'), std::string::npos) << reply.text;
  }
}

TEST_F(SimulationModuleTest, ParticipantsAreNamesOfRobots) {
  EXPECT_EQ(Ask("set_participants robot2").error, 0);
  EXPECT_FALSE(world_.board.Owners()[0].participates);
  EXPECT_EQ(Ask("set_participants robot9").error, 10);
  EXPECT_EQ(Ask("set_participants").error, 0);
  EXPECT_TRUE(world_.board.Owners()[0].participates);
}

TEST_F(SimulationModuleTest, ReleaseRobotFreesItAtOnceAndClosesItsOwner) {
  const SlotId slot = world_.board.FindSlot("robot1");
  world_.board.Claim(slot, {42, "bob", "peer:42", false});
  Ask("hello ana");
  EXPECT_EQ(Ask("release_robot robot1").error, 0);
  EXPECT_EQ(world_.board.Owners()[0].id, 0u);
  EXPECT_THAT(actions_.closed, ElementsAre("robot1 42 released by ana"));
  EXPECT_THAT(Ask("release_robot /robot2").text, HasSubstr("nobody"));
  const Message unknown = Ask("release_robot robot3");
  EXPECT_EQ(unknown.error, 10);
  EXPECT_THAT(unknown.text, HasSubstr("robot1 robot2"));
}

TEST_F(SimulationModuleTest, QuitAnswersFirst) {
  EXPECT_EQ(Ask("quit").error, 0);
  EXPECT_EQ(actions_.quits, 1);
}

TEST_F(SimulationModuleTest, NothingIsOwnedOrAttachedHere) {
  EXPECT_EQ(Ask("claim").error, 5);
  client_->SendMessage(Message{0, "", command::kRelease, {}, {}});
  EXPECT_EQ(client_->received.back().error, 5);
  EXPECT_EQ(Ask("attach pose").error, 10);
}

TEST_F(SimulationModuleTest, StrangersReadButChangeOnlyWithTheToken) {
  FakeClient stranger(*module_, 9, false);
  for (const char* line :
       {"run", "pause", "step 1", "reset", "set_mode free", "set_step 0.01", "set_speed 1",
        "load_scenario hall", "quit", "stop_all", "set_participants", "reload", "release_robot robot1"}) {
    EXPECT_EQ(stranger.Ask(line).error, 12) << line;
  }
  EXPECT_EQ(stranger.Ask("get_status").error, 0);
  EXPECT_EQ(stranger.Ask("describe").error, 0);
  EXPECT_EQ(stranger.Ask("hello eve").error, 0);
  EXPECT_EQ(stranger.Ask("hello eve wrong").error, 12);
  EXPECT_EQ(stranger.Ask("quit").error, 12);
  EXPECT_EQ(stranger.Ask("hello eve secret").error, 0);
  EXPECT_EQ(stranger.Ask("quit").error, 0);
  EXPECT_EQ(actions_.quits, 1);
}

TEST_F(SimulationModuleTest, WrongRequestsGetTheDocumentedError) {
  for (const CommandSpec& spec : module_->table().commands()) {
    if (spec.id == command::kPing) continue;
    Message right;
    right.command = spec.id;
    if (spec.text == TextUse::kRest) right.text = "robot1";
    for (const ValueSpec& param : spec.params) {
      if (!param.optional) right.params.push_back(1);
    }
    right.data.assign(spec.data.size(), 0.01);
    const auto error_of = [&](const Message& request) {
      client_->SendMessage(request);
      EXPECT_FALSE(client_->is_waiting()) << spec.name;
      return client_->received.back().error;
    };
    Message wrong = right;
    wrong.params = {1, 2, 3, 4};
    EXPECT_EQ(error_of(wrong), 2) << spec.name;
    wrong = right;
    wrong.data.push_back(1);
    EXPECT_EQ(error_of(wrong), 3) << spec.name;
    if (spec.text == TextUse::kNone) {
      wrong = right;
      wrong.text = "text";
      EXPECT_EQ(error_of(wrong), 2) << spec.name;
    }
    if (!spec.data.empty()) {
      wrong = right;
      wrong.data[0] = INFINITY;
      EXPECT_EQ(error_of(wrong), 4) << spec.name;
    }
  }
  EXPECT_EQ(Ask("get_status").error, 0);
  client_->SendMessage(Message{0, "", command::kGetStatus, {0, 5}, {}});
  EXPECT_EQ(client_->received.back().error, 4);
  client_->SendMessage(Message{0, "", 12, {}, {}});
  EXPECT_EQ(client_->received.back().error, 1);
  EXPECT_TRUE(edits_.empty());
}

TEST_F(SimulationModuleTest, AfterTheEndEditsAreRefused) {
  edits_.Close();
  const Message reply = Ask("run");
  EXPECT_EQ(reply.error, 5);
  EXPECT_THAT(reply.text, HasSubstr("stopping"));
}

TEST_F(SimulationModuleTest, ReleaseRobotTakesOnlyThatOneFromATeamAndClosesNothing) {
  const std::vector<SlotId> both{world_.board.FindSlot("robot1"), world_.board.FindSlot("robot2")};
  world_.board.ClaimAll(both, {50, "flock", "127.0.0.1:50", false, true});
  EXPECT_EQ(Ask("release_robot robot1").error, 0);
  EXPECT_TRUE(actions_.closed.empty());
  EXPECT_EQ(world_.board.Team(50), std::vector<SlotId>{both[1]});
}

TEST_F(SimulationModuleTest, ReleaseRobotUnloadsAController) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[0].controller.name = "diffuse";
  world_.Load(scenario, Mode::kLockstep);
  EXPECT_EQ(Ask("release_robot robot1").error, 0);
  EXPECT_EQ(LastEdit<edit::UnloadController>().robot, "robot1");
}

TEST_F(SimulationModuleTest, StopAllSaysHowManyRobotsControllersDriveOn) {
  EXPECT_EQ(Ask("stop_all").text, "");
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[0].controller.name = "diffuse";
  world_.Load(scenario, Mode::kLockstep);
  EXPECT_EQ(Ask("stop_all").text,
            "robots that loaded controllers drive go on (1): pause, or release_robot ROBOT");
}

TEST_F(SimulationModuleTest, StatusNamesTheControllerThatOwnsARobot) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[1].controller.name = "diffuse";
  world_.Load(scenario, Mode::kLockstep);
  const json::array robots = Status().at("robots").as_array();
  EXPECT_TRUE(robots[0].at("owner").is_null());
  EXPECT_EQ(robots[1].at("owner").as_string(), "controller diffuse");
}

}  // namespace
}  // namespace coopdyn
