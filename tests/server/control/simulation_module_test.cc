// SPDX-License-Identifier: MIT
// /simulation on the real boards, with a stepping thread that applies edits when told; no sockets, no
// physics.
#include "server/control/simulation_module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/json.hpp>
#include <filesystem>
#include <fstream>

#include "tests/server/devices/fake_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace json = boost::json;

class FakeActions final : public ControlActions {
 public:
  void ApplyScene(const Scene& scene) override { applied.push_back(scene.scenario->name); }
  void CloseClient(const std::string& robot, ClientId client, const std::string& reason) override {
    closed.push_back(robot + " " + std::to_string(client) + " " + reason);
  }
  void Quit() override { ++quits; }
  std::string recording() const override { return "night.run"; }
  std::string http() const override { return ""; }

  std::vector<std::string> applied, closed;
  int quits = 0;
};

class SimulationModuleTest : public testing::Test {
 protected:
  SimulationModuleTest() {
    folder_ = std::filesystem::path(testing::TempDir()) / ("coopdyn_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    Write("hall.scenario", "[FLOOR]\nsize 8 8 0.1\n");
    Write("broken.scenario", "[FLOOR]\nsize 8 banana 0.1\n");
    run_.SetStatus(RunStatus{});
    module_.emplace(services_, thread_.poster());
    client_.emplace(*module_, 1);
  }
  ~SimulationModuleTest() override {
    client_.reset();
    module_.reset();
    std::filesystem::remove_all(folder_);
  }

  void Write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  /// What the stepping thread does: answers every edit, keeping what it was.
  void ApplyEdits() {
    for (Edit& each : edits_.TakeAll()) {
      EditResult result = next_result_;
      if (const auto* load = std::get_if<edit::Load>(&each.action); load && result.error == Error::kOk) {
        world_.Load(load->scenario, Mode::kLockstep);
      }
      if (std::holds_alternative<edit::Reset>(each.action)) {
        world_.Load(SmallScenario(2), Mode::kLockstep, StepEnd::kReset);
      }
      if (auto* participants = std::get_if<edit::SetParticipants>(&each.action)) {
        const Verdict verdict = world_.board.SetParticipants(participants->names, 0);
        result.error = verdict.error;
        result.text = verdict.text;
      }
      if (auto* step = std::get_if<edit::Step>(&each.action); step && result.error == Error::kOk) {
        world_.board.WaitSteps(step->steps, step->done);
        applied_.push_back(std::move(each.action));
        continue;
      }
      result.frame = world_.frames.Latest();
      each.done(result);
      applied_.push_back(std::move(each.action));
    }
    thread_.Run();
  }
  /// Sends a line, lets its edit be applied, returns the reply.
  Message Ask(const std::string& line) {
    client_->Send(line);
    ApplyEdits();
    EXPECT_FALSE(client_->is_waiting()) << line;
    return client_->received.back();
  }
  template <typename T>
  const T& LastEdit() {
    return std::get<T>(applied_.back());
  }
  json::object Status(const std::string& line = "get_status") {
    return json::parse(Ask(line).text).as_object();
  }

  std::filesystem::path folder_;
  ManualClock clock_;
  NameTable names_;
  ConnectionRoster roster_;
  TokenGuard guard_{"secret", true};
  RobotLibrary robots_{
      SearchPath{{std::filesystem::path(testing::TempDir()) / ("coopdyn_" + std::to_string(getpid()))}}};
  Doorbell bell_;
  EditQueue edits_{bell_};
  RunControl run_;
  FakeActions actions_;
  SmallWorld world_{2};
  SimulationServices services_{world_.board, world_.frames, edits_, run_,     names_, roster_,
                               robots_,      guard_,        clock_, actions_, "1.2.3"};
  FakeThread thread_;
  EditResult next_result_;
  std::vector<EditAction> applied_;
  std::optional<SimulationModule> module_;
  std::optional<FakeClient> client_;
};

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
  EXPECT_THAT(actions_.applied, ElementsAre("small"));
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
  EXPECT_THAT(actions_.applied, ElementsAre("hall"));
  EXPECT_EQ(Status()["scenario"], "hall");
}

TEST_F(SimulationModuleTest, ScenarioIsLoadedFromItsText) {
  Message request;
  request.command = command::kLoadScenario;
  request.text = "[FLOOR]\nsize 6 6 0.1\n";
  client_->SendMessage(request);
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
  EXPECT_TRUE(actions_.applied.empty());
}

TEST_F(SimulationModuleTest, ReloadReadsTheFileAgain) {
  EXPECT_EQ(Ask("reload").error, 5) << "the first one came from nowhere";
  Ask("load_scenario hall");
  Write("hall.scenario", "[FLOOR]\nsize 5 5 0.1\n");
  EXPECT_EQ(Ask("reload").error, 0);
  EXPECT_EQ(LastEdit<edit::Load>().scenario->floor.length_m, 5);
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

TEST_F(SimulationModuleTest, StatusTellsEverything) {
  names_.AddOwn("/robot1/motors", 10002, nullptr);
  world_.board.Claim(world_.board.FindSlot("robot1"), {42, "bob", "peer:42", false});
  roster_.Add({42, "/robot1/motors", "peer:42", "bob"});
  clock_.Advance(1'500'000'000);
  run_.AddEvent({3, 0.03, "warning", "robot1 has left the floor"});
  RunStatus run;
  run.mode = Mode::kLockstep;
  run.speed = 0;
  run.real_time_factor = std::nan("");
  run.frozen = {"BOX_1"};
  run_.SetStatus(run);
  const json::object status = Status();
  EXPECT_EQ(status.at("version"), "1.2.3");
  EXPECT_EQ(status.at("protocol"), kProtocolVersion);
  EXPECT_EQ(status.at("mode"), "lockstep");
  EXPECT_EQ(status.at("state"), "waiting");
  EXPECT_TRUE(status.at("speed").is_null());
  EXPECT_TRUE(status.at("rtf").is_null());
  EXPECT_TRUE(status.at("http").is_null());
  EXPECT_EQ(status.at("recording"), "night.run");
  EXPECT_EQ(status.at("hash").as_string(), HashText(StateHash(*world_.frames.Latest())));
  EXPECT_EQ(status.at("hash").as_string().size(), 16u);
  EXPECT_DOUBLE_EQ(status.at("step_s").to_number<double>(), 0.01);
  const json::object& robot = status.at("robots").as_array().at(0).as_object();
  EXPECT_EQ(robot.at("name"), "robot1");
  EXPECT_EQ(robot.at("type"), "small");
  EXPECT_EQ(robot.at("owner"), "bob");
  EXPECT_EQ(robot.at("modules").as_array().at(0).as_object().at("port"), 10002);
  EXPECT_TRUE(status.at("robots").as_array().at(1).as_object().at("owner").is_null());
  EXPECT_EQ(status.at("awaiting_count"), 2);
  const json::object& awaited = status.at("awaiting").as_array().at(1).as_object();
  EXPECT_EQ(awaited.at("robot"), "robot2");
  EXPECT_EQ(awaited.at("why"), "no client");
  EXPECT_DOUBLE_EQ(awaited.at("seconds").to_number<double>(), 1.5);
  const json::array& clients = status.at("clients").as_array();
  ASSERT_EQ(clients.size(), 2u);
  EXPECT_EQ(clients[0].at("module"), "/simulation");
  EXPECT_TRUE(clients[0].at("name").is_null());
  EXPECT_EQ(clients[1].at("owner"), true);
  EXPECT_EQ(status.at("frozen").as_array().at(0), "BOX_1");
  EXPECT_EQ(status.at("events").as_array().at(0).at("text"), "robot1 has left the floor");
}

TEST_F(SimulationModuleTest, ObjectsOfAListHaveTheSameKeys) {
  world_.board.Claim(world_.board.FindSlot("robot1"), {42, "bob", "peer:42", false});
  FakeClient named(*module_, 2);
  named.Ask("hello ana");
  const json::object status = Status();
  for (const char* list : {"robots", "clients", "awaiting"}) {
    std::vector<std::string> first;
    for (const json::value& each : status.at(list).as_array()) {
      std::vector<std::string> keys;
      for (const auto& member : each.as_object()) keys.emplace_back(member.key());
      if (first.empty()) first = keys;
      EXPECT_EQ(keys, first) << list;
    }
    EXPECT_FALSE(first.empty()) << list;
  }
}

TEST_F(SimulationModuleTest, ManyRobotsAreListedInPages) {
  world_.Load(SmallScenario(300), Mode::kLockstep);
  const json::object status = Status();
  EXPECT_EQ(status.at("robots").as_array().size(), 256u);
  EXPECT_EQ(status.at("robot_count"), 300);
  EXPECT_EQ(status.at("awaiting").as_array().size(), 20u);
  EXPECT_EQ(status.at("awaiting_count"), 300);
  client_->SendMessage(Message{0, "", command::kGetStatus, {257, 1000}, {}});
  const json::value rest = json::parse(client_->received.back().text);
  ASSERT_EQ(rest.at("robots").as_array().size(), 44u);
  EXPECT_EQ(rest.at("robots").as_array().at(0).at("name"), "robot257");
}

TEST_F(SimulationModuleTest, PausedIsNotWaiting) {
  RunStatus run;
  run.state = RunState::kPaused;
  run_.SetStatus(run);
  EXPECT_EQ(Status()["state"], "paused");
}

TEST_F(SimulationModuleTest, StatusIsPushedToSubscribersBeforeTheReplyOfItsStep) {
  Ask("subscribe 1");
  client_->Send("ready");
  world_.Step();
  thread_.Run();
  ASSERT_EQ(client_->received.size(), 3u);
  EXPECT_EQ(client_->received[1].command, -100);
  EXPECT_EQ(StepOf(client_->received[1]), 1);
  EXPECT_EQ(json::parse(client_->received[1].text).at("step"), 1);
  EXPECT_EQ(client_->received[2].command, command::kReady);
}

TEST_F(SimulationModuleTest, AfterTheEndEditsAreRefused) {
  edits_.Close();
  const Message reply = Ask("run");
  EXPECT_EQ(reply.error, 5);
  EXPECT_THAT(reply.text, HasSubstr("stopping"));
}

}  // namespace
}  // namespace coopdyn
