// SPDX-License-Identifier: MIT
// The contract of docs/protocol.md at the level of modules: requests, owners, waits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/robot/robot_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(RobotModuleTest, PingEchoesAndIsStamped) {
  auto client = Connect(kPose);
  const Message reply = client->Ask("ping (1 2) 0.5");
  EXPECT_EQ(reply.error, 0);
  EXPECT_THAT(reply.params, ElementsAre(1, 2));
  EXPECT_THAT(reply.data, ElementsAre(0.5, 0, 0));
}

TEST_F(RobotModuleTest, DescribeTellsModuleAndVersion) {
  auto client = Connect(kTarget);
  EXPECT_THAT(client->Ask("describe").text, testing::AllOf(HasSubstr("1.2.3"), HasSubstr("get_targets")));
}

TEST_F(RobotModuleTest, EveryReplyWithoutErrorEndsWithTimeAndStep) {
  for (int module : {kMotors, kDistance, kTarget, kPose}) {
    SetMode(Mode::kRealtime);
    auto client = Connect(module);
    for (const CommandSpec& spec : Module(module).table().commands()) {
      Message request;
      request.command = spec.id;
      if (spec.text == TextUse::kRest && !spec.text_optional) request.text = "ana";
      if (spec.text == TextUse::kOrNumber) request.text = "red";
      request.data.assign(spec.data.size(), 0.0);
      if (spec.id == command::kPing) request.data.clear();
      const std::uint64_t before = world_.frames.Latest()->step;
      client->SendMessage(request);
      if (client->is_waiting()) {
        world_.Step();
        thread_.Run();
      }
      ASSERT_FALSE(client->is_waiting()) << spec.name;
      const Message reply = client->received.back();
      EXPECT_EQ(reply.command, spec.id);
      if (reply.error != 0) {
        EXPECT_TRUE(module != kMotors && (spec.id == command::kClaim || spec.id == command::kRelease))
            << spec.name;
        continue;
      }
      const std::uint64_t now = world_.frames.Latest()->step;
      EXPECT_EQ(now, before + (spec.id == command::kReady ? 1 : 0)) << spec.name;
      ASSERT_GE(reply.data.size(), 2u) << spec.name;
      EXPECT_EQ(StepOf(reply), static_cast<double>(now)) << spec.name;
      EXPECT_EQ(reply.data[reply.data.size() - 2], ToSeconds(static_cast<Nanoseconds>(now) * kDefaultStep))
          << spec.name;
    }
  }
}

TEST_F(RobotModuleTest, WrongRequestsGetTheDocumentedErrorAndNoValues) {
  for (int module : {kMotors, kDistance, kTarget, kPose}) {
    auto client = Connect(module);
    const auto error_of = [&](Message request) {
      client->SendMessage(std::move(request));
      EXPECT_FALSE(client->is_waiting());
      const Message reply = client->received.back();
      EXPECT_TRUE(reply.params.empty() && reply.data.empty());
      EXPECT_NE(reply.text, "");
      return reply.error;
    };
    for (const CommandSpec& spec : Module(module).table().commands()) {
      if (spec.id == command::kPing) continue;  // accepts anything
      Message right;
      right.command = spec.id;
      if (spec.text == TextUse::kRest) right.text = "ana";
      if (spec.text == TextUse::kOrNumber) right.text = "red";
      right.data.assign(spec.data.size(), 0.0);
      Message wrong = right;
      wrong.params = {1, 2, 3, 4};
      EXPECT_EQ(error_of(wrong), 2) << spec.name << " params";
      wrong = right;
      wrong.data.push_back(1);
      EXPECT_EQ(error_of(wrong), 3) << spec.name << " data";
      wrong = right;
      wrong.error = 5;
      EXPECT_EQ(error_of(wrong), 7) << spec.name << " error";
      if (spec.text == TextUse::kNone) {
        wrong = right;
        wrong.text = "text";
        EXPECT_EQ(error_of(wrong), 2) << spec.name << " text";
      }
      if (!spec.data.empty()) {
        wrong = right;
        wrong.data[0] = std::nan("");
        EXPECT_EQ(error_of(wrong), 4) << spec.name << " nan";
      }
      if (!spec.params.empty() && spec.params[0].name == "steps") {
        wrong = right;
        wrong.params = {0};
        EXPECT_EQ(error_of(wrong), 4) << spec.name << " steps";
      }
    }
    Message unknown;
    unknown.command = 77;
    EXPECT_EQ(error_of(unknown), 1);
    unknown.command = -12;
    EXPECT_EQ(error_of(unknown), 1);
  }
  EXPECT_TRUE(world_.board.Owners()[0].id == 0) << "a refused command owns nothing";
}

TEST_F(RobotModuleTest, ActuatorCommandInLockstepIsAnsweredAfterTheStep) {
  auto client = Connect(kMotors);
  client->Send("set_velocity 0.2 0");
  EXPECT_TRUE(client->is_waiting());
  world_.Step();
  thread_.Run();
  ASSERT_EQ(client->received.size(), 1u);
  EXPECT_THAT(client->received[0].params, ElementsAre(1));
  EXPECT_THAT(client->received[0].data, ElementsAre(0.01, 1));
  EXPECT_DOUBLE_EQ(SetpointOf(*world_.frames.Latest(), 0)[0], 2);
}

TEST_F(RobotModuleTest, ActuatorCommandInRealTimeIsAnsweredAtOnce) {
  for (const Mode mode : {Mode::kRealtime, Mode::kFree}) {
    SetMode(mode);
    auto client = Connect(kMotors);
    const Message reply = client->Ask("set_velocity 0.2 0");
    EXPECT_THAT(reply.params, ElementsAre(static_cast<int>(mode)));
    EXPECT_EQ(StepOf(reply), 0);
    client->CloseNow();
    world_.board.StopAll();
  }
}

TEST_F(RobotModuleTest, CommandForSeveralStepsIsAnsweredAfterTheLastInEveryMode) {
  SetMode(Mode::kRealtime);
  auto client = Connect(kMotors);
  client->Send("set_velocity (3) 0.2 0");
  for (int i = 0; i < 2; ++i) world_.Step();
  thread_.Run();
  EXPECT_TRUE(client->is_waiting());
  world_.Step();
  thread_.Run();
  EXPECT_EQ(StepOf(client->received.at(0)), 3);
}

TEST_F(RobotModuleTest, LimitedCommandSaysSoInItsReply) {
  world_.StepInline();
  auto one = Connect(kMotors, 0), two = Connect(kMotors, 1);
  one->Send("set_velocity 5 0");
  two->Send("set_velocity 0.1 0");
  thread_.Run();
  EXPECT_EQ(one->received.at(0).text, "limited to 1 m/s 0 rad/s");
  EXPECT_EQ(two->received.at(0).text, "");
  EXPECT_EQ(one->received.at(0).error, 0);
}

TEST_F(RobotModuleTest, StepRunInsideTheCommandIsAnsweredWithoutWakeUp) {
  world_.StepInline();
  auto one = Connect(kMotors, 0), two = Connect(kMotors, 1);
  one->Send("set_velocity 0.1 0");
  EXPECT_TRUE(one->is_waiting());
  two->Send("set_velocity 0.1 0");
  EXPECT_FALSE(two->is_waiting());
  EXPECT_EQ(thread_.posted(), 1u) << "one wake-up, for the other robot";
  thread_.Run();
  EXPECT_EQ(StepOf(one->received.at(0)), 1);
  EXPECT_EQ(StepOf(two->received.at(0)), 1);
}

TEST_F(RobotModuleTest, ReadyOnMotorsKeepsTheSetPointsAndClaims) {
  world_.StepInline();
  auto one = Connect(kMotors, 0), two = Connect(kMotors, 1), other = Connect(kMotors, 0);
  one->Send("set_velocity 0.2 0");
  two->Send("ready");
  thread_.Run();
  one->Send("ready");
  two->Send("ready");
  thread_.Run();
  EXPECT_EQ(StepOf(one->received.back()), 2);
  EXPECT_DOUBLE_EQ(SetpointOf(*world_.frames.Latest(), 0)[0], 2);
  EXPECT_EQ(world_.board.Owners()[1].id, two->id());
  EXPECT_EQ(other->Ask("ready").error, 6);
}

TEST_F(RobotModuleTest, ReadyElsewhereMakesNobodyReadyButWaits) {
  auto watcher = Connect(kPose);
  watcher->Send("ready 2");
  EXPECT_FALSE(world_.board.AllReady());
  world_.Step();
  thread_.Run();
  EXPECT_TRUE(watcher->is_waiting());
  world_.Step();
  thread_.Run();
  EXPECT_THAT(watcher->received.at(0).params, ElementsAre(1));
  EXPECT_EQ(StepOf(watcher->received[0]), 2);
}

TEST_F(RobotModuleTest, SecondCommanderGetsErrorSixWithTheOwnersName) {
  SetMode(Mode::kRealtime);
  auto one = Connect(kMotors), two = Connect(kMotors);
  one->Ask("hello ana");
  one->Ask("set_velocity 0.1 0");
  const Message reply = two->Ask("set_velocity 0.1 0");
  EXPECT_EQ(reply.error, 6);
  EXPECT_THAT(reply.text, HasSubstr("ana"));
  EXPECT_EQ(two->Ask("claim").error, 6);
  EXPECT_EQ(two->Ask("release").error, 6);
  EXPECT_EQ(two->Ask("get_wheels").error, 0) << "reading is open to all";
}

TEST_F(RobotModuleTest, ReleaseAndCloseFreeTheRobot) {
  SetMode(Mode::kRealtime);
  auto one = Connect(kMotors), two = Connect(kMotors);
  one->Ask("claim");
  EXPECT_EQ(one->Ask("release").error, 0);
  EXPECT_EQ(two->Ask("set_velocity 0.1 0").error, 0);
  two->CloseNow();
  EXPECT_EQ(one->Ask("set_velocity 0.1 0").error, 0);
}

TEST_F(RobotModuleTest, HelloTakesTheMotorsOverFromTheSameNameOnly) {
  auto old = Connect(kMotors), reader = Connect(kPose), fresh = Connect(kMotors), other = Connect(kMotors);
  old->Ask("hello ana");
  reader->Ask("hello ana");
  old->Send("set_velocity (5) 0.2 0");
  EXPECT_EQ(other->Ask("hello bob").error, 0);
  EXPECT_EQ(old->closed_because, "");
  EXPECT_EQ(fresh->Ask("hello ana").error, 0);
  EXPECT_EQ(old->closed_because, "taken over by ana");
  EXPECT_EQ(reader->closed_because, "");
  fresh->Send("set_velocity 0.5 0");
  EXPECT_EQ(old->received.back().error, 6) << "the rest of its command is replaced";
  EXPECT_THAT(old->received.back().text, HasSubstr("ana"));
  EXPECT_TRUE(fresh->is_waiting());
  world_.Step();
  thread_.Run();
  EXPECT_FALSE(fresh->is_waiting());
  EXPECT_DOUBLE_EQ(SetpointOf(*world_.frames.Latest(), 0)[0], 5);
}

TEST_F(RobotModuleTest, HelloTakesOneNameAndAToken) {
  auto client = Connect(kPose);
  Message hello;
  hello.command = command::kHello;
  for (const char* text : {" ", "a b c"}) {
    hello.text = text;
    client->SendMessage(hello);
    EXPECT_EQ(client->received.back().error, 2) << text;
  }
}

TEST_F(RobotModuleTest, ClaimOnAReadingModuleSaysWhichModuleHasAnOwner) {
  auto client = Connect(kDistance);
  const Message reply = client->Ask("claim");
  EXPECT_EQ(reply.error, 5);
  EXPECT_THAT(reply.text, HasSubstr("/robot1/motors"));
}

TEST_F(RobotModuleTest, ResetLoadAndStopEndAWaitWithTheirReason) {
  const auto end_of = [&](StepEnd end) {
    auto client = Connect(kMotors);
    auto watcher = Connect(kTarget);
    client->Send("set_velocity 0.1 0");
    watcher->Send("ready");
    if (end == StepEnd::kStopping) {
      world_.board.Stop(world_.frames.Latest());
    } else {
      world_.Load(SmallScenario(2), Mode::kLockstep, end);
    }
    thread_.Run();
    EXPECT_EQ(watcher->received.at(0).text, client->received.at(0).text);
    EXPECT_EQ(client->received.at(0).error, 5);
    return client->received.at(0).text;
  };
  EXPECT_EQ(end_of(StepEnd::kReset), "reset");
  EXPECT_EQ(end_of(StepEnd::kLoad), "load");
  EXPECT_EQ(end_of(StepEnd::kStopping), "the daemon is stopping");
}

TEST_F(RobotModuleTest, NobodyStandsOrWaitsForMoreStepsThanTheMost) {
  auto motors = Connect(kMotors), pose = Connect(kPose);
  const auto refused = [](FakeClient& client, command::Id command, std::vector<double> data) {
    client.SendMessage(Message{0, "", command, {kMaxSteps + 1}, std::move(data)});
    const Message& reply = client.received.back();
    EXPECT_EQ(reply.error, 4) << command;
    EXPECT_THAT(reply.text, HasSubstr("1 to 10000000")) << command;
  };
  refused(*motors, command::kReady, {});
  refused(*motors, command::kSetVelocity, {0.1, 0});
  refused(*motors, command::kStop, {});
  refused(*pose, command::kReady, {});
  motors->Send("ready 10000000");
  EXPECT_TRUE(motors->is_waiting());
}

TEST_F(RobotModuleTest, KeptRobotDrivesOnAfterALoadThatMovesItsPlace) {
  auto two = Connect(kMotors, 1);
  auto pose = Connect(kPose, 1);
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  std::swap(scenario->robots[0], scenario->robots[1]);
  world_.Load(scenario, Mode::kRealtime);
  EXPECT_EQ(two->Ask("set_velocity 0.3 0").error, 0);
  world_.Step();
  EXPECT_DOUBLE_EQ(SetpointOf(*world_.frames.Latest(), 0)[0], 3);
  EXPECT_DOUBLE_EQ(pose->Ask("get_pose").data[1], 10);
}

TEST_F(RobotModuleTest, RobotThatIsGoneAnswersErrorFive) {
  auto motors = Connect(kMotors, 1);
  auto pose = Connect(kPose, 1);
  world_.Load(SmallScenario(1), Mode::kLockstep);
  EXPECT_EQ(motors->Ask("set_velocity 0.3 0").error, 5);
  EXPECT_EQ(motors->Ask("ready").error, 5);
  EXPECT_EQ(pose->Ask("get_pose").error, 5);
  EXPECT_EQ(pose->Ask("ping").error, 0);
}

TEST_F(RobotModuleTest, EndOfInputFreesTheRobotButWhatWasSentStillRuns) {
  world_.StepInline();
  auto one = Connect(kMotors, 0), two = Connect(kMotors, 1), heir = Connect(kMotors, 0);
  one->Send("set_velocity 0.2 0");
  one->EndInput();
  EXPECT_EQ(world_.board.Owners()[0].id, 0u);
  two->Send("ready");
  thread_.Run();
  EXPECT_EQ(StepOf(one->received.at(0)), 1);
  one->Send("set_velocity 0.3 0");  // was in its buffer
  two->Send("ready");
  thread_.Run();
  EXPECT_EQ(one->received.at(1).error, 0);
  EXPECT_DOUBLE_EQ(SetpointOf(*world_.frames.Latest(), 0)[0], 3);
  EXPECT_EQ(world_.board.Owners()[0].id, 0u);
  EXPECT_EQ(heir->Ask("claim").error, 0);
  EXPECT_EQ(one->Ask("set_velocity 0.3 0").error, 6);
}

TEST_F(RobotModuleTest, WaitingForNamesTheFirstAwaitedRobot) {
  auto client = Connect(kMotors, 0);
  client->Send("set_velocity 0.1 0");
  clock_.Advance(1'200'000'000);
  EXPECT_THAT(
      Module(kMotors).WaitingFor(),
      testing::StartsWith("waiting for robot2 (no client), 1.2 s: start its program, or let the others "
                          "go on with set_participants robot1,"));
  SetMode(Mode::kRealtime);
  EXPECT_EQ(Module(kMotors).WaitingFor(), "");
}

TEST_F(RobotModuleTest, RosterKnowsWhoIsConnected) {
  auto client = Connect(kPose);
  client->Ask("hello ana");
  std::size_t total = 0;
  const auto list = roster_.List(10, total);
  ASSERT_EQ(total, 1u);
  EXPECT_EQ(list[0].module, "/robot1/pose");
  EXPECT_EQ(list[0].name, "ana");
  client->CloseNow();
  roster_.List(10, total);
  EXPECT_EQ(total, 0u);
}

class PrivateRobotTest : public RobotModuleTest {
 protected:
  PrivateRobotTest() { guard_ = TokenGuard("secret", true); }
};

TEST_F(PrivateRobotTest, StrangersDriveOnlyWithTheToken) {
  SetMode(Mode::kRealtime);
  auto stranger = Connect(kMotors, 0, false);
  for (const char* line : {"set_velocity 0.1 0", "claim", "release", "ready", "stop", "hello eve"}) {
    EXPECT_EQ(stranger->Ask(line).error, 12) << line;
  }
  EXPECT_EQ(stranger->Ask("get_wheels").error, 0);
  EXPECT_EQ(stranger->Ask("hello eve wrong").error, 12);
  EXPECT_EQ(stranger->Ask("set_velocity 0.1 0").error, 12);
  EXPECT_EQ(stranger->Ask("hello eve secret").error, 0);
  EXPECT_EQ(stranger->Ask("set_velocity 0.1 0").error, 0);
}

}  // namespace
}  // namespace coopdyn
