// SPDX-License-Identifier: MIT
// The reply to get_status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/control/simulation_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

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
  run.unsolved = 3;
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
  EXPECT_THAT(std::string(awaited.at("cure").as_string()), testing::HasSubstr("set_participants robot1"));
  EXPECT_TRUE(status.at("awaiting").as_array().at(0).at("cure").is_null());
  const json::array& clients = status.at("clients").as_array();
  ASSERT_EQ(clients.size(), 2u);
  EXPECT_EQ(clients[0].at("module"), "/simulation");
  EXPECT_TRUE(clients[0].at("name").is_null());
  EXPECT_EQ(clients[1].at("owner"), true);
  EXPECT_EQ(status.at("frozen").as_array().at(0), "BOX_1");
  EXPECT_EQ(status.at("unsolved"), 3);
  EXPECT_EQ(status.at("events").as_array().at(0).at("text"), "robot1 has left the floor");
}

TEST_F(SimulationModuleTest, StatusTellsWhichRobotsMoveThoughNobodyDrivesThem) {
  world_.Load(SmallScenario(2), Mode::kRealtime);
  const SlotId robot = world_.board.FindSlot("robot1");
  world_.board.Command(robot, {42, "", "peer:42", false}, Wheels(1, 1), {}, nullptr);
  world_.Step();
  const auto moving = [this](std::size_t index) {
    return Status().at("robots").as_array().at(index).at("still_moving").as_bool();
  };
  EXPECT_FALSE(moving(0)) << "somebody drives it";
  world_.board.Closed(robot, 42);
  EXPECT_TRUE(moving(0));
  EXPECT_FALSE(moving(1));
}

TEST_F(SimulationModuleTest, StatusTellsForHowLongAClientIsSilentInRealTime) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->simulation.watchdog_s = 2;
  world_.Load(scenario, Mode::kRealtime);
  const SlotId robot = world_.board.FindSlot("robot1");
  const Client bob{42, "bob", "peer:42"};
  world_.board.Command(robot, bob, Wheels(1, 1), {}, nullptr);
  world_.board.NoteHeard(robot, bob, clock_.Now());
  world_.Step();
  clock_.Advance(2 * kNanosecondsPerSecond);
  const auto told = [this](std::size_t index, const char* key) {
    return Status().at("robots").as_array().at(index).at(key);
  };
  EXPECT_DOUBLE_EQ(told(0, "silent_s").to_number<double>(), 2);
  EXPECT_TRUE(told(1, "silent_s").is_null());
  EXPECT_EQ(told(0, "watchdog_stopped"), false);
  world_.board.StopSilent(clock_.Now());
  EXPECT_EQ(told(0, "watchdog_stopped"), true);
  world_.board.SetMode(Mode::kLockstep, clock_.Now());
  EXPECT_TRUE(told(0, "silent_s").is_null());
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

}  // namespace
}  // namespace coopdyn
