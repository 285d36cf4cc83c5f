// SPDX-License-Identifier: MIT
// Robots whose client is late or lost: deadlines, and what on_disconnect says.
#include <gtest/gtest.h>

#include <limits>

#include "command_board_fixture.h"

namespace coopdyn {
namespace {

class DeadlineTest : public CommandBoardTest, public testing::WithParamInterface<LossPolicy> {
 protected:
  void SetUp() override {
    RobotEntry late = MakeRobot("robot2");
    late.deadline_s = 0.5;
    late.on_deadline = GetParam();
    UseEntries({MakeRobot("robot1"), late});
    board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
    board_.Command(slot("robot2"), bob_, Wheels(2, 2), {}, Note("bob"));
    RunStep();
    board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  }
};

TEST_P(DeadlineTest, LetsTheOthersGoOnUntilItsNextCommand) {
  EXPECT_EQ(board_.NextDeadline(), kSecond / 2);
  EXPECT_TRUE(board_.FireDeadlines(kSecond / 2 - 1).empty());
  const std::vector<FiredDeadline> fired = board_.FireDeadlines(kSecond / 2);
  ASSERT_EQ(fired.size(), 1u);
  EXPECT_EQ(fired[0].robot, "robot2");
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(board_.NextDeadline(), std::numeric_limits<Nanoseconds>::max());
  const WheelSpeeds expected = GetParam() == LossPolicy::kHold ? WheelSpeeds{2, 2} : WheelSpeeds{0, 0};
  EXPECT_EQ(RunStep()[1], expected);

  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  EXPECT_TRUE(board_.AllReady());
  board_.Command(slot("robot2"), bob_, Wheels(3, 3), {}, Note("bob"));
  EXPECT_EQ(RunStep()[1], (WheelSpeeds{3, 3}));
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  EXPECT_FALSE(board_.AllReady());  // it participates again
}

INSTANTIATE_TEST_SUITE_P(Policies, DeadlineTest,
                         testing::Values(LossPolicy::kHold, LossPolicy::kStop, LossPolicy::kDrop));

class DisconnectTest : public CommandBoardTest {
 protected:
  /// Robot 2 drives at (2, 2) and loses its client, robot 1 has a command.
  void Lose(std::optional<LossPolicy> policy) {
    RobotEntry lost = MakeRobot("robot2");
    lost.on_disconnect = policy;
    UseEntries({MakeRobot("robot1"), lost});
    board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
    board_.Command(slot("robot2"), bob_, Wheels(2, 2), {}, Note("bob"));
    RunStep();
    board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
    board_.InputEnded(slot("robot2"), bob_.id);
    EXPECT_FALSE(board_.AllReady());  // the policy acts only after the backlog
    board_.Closed(slot("robot2"), bob_.id);
  }
};

TEST_F(DisconnectTest, ByDefaultTheWorldWaits) {
  Lose(std::nullopt);
  EXPECT_FALSE(board_.AllReady());
  EXPECT_EQ(board_.Awaiting(now_, 1, nullptr)[0].why, "no client");
}

TEST_F(DisconnectTest, HoldKeepsTheSetpoints) {
  Lose(LossPolicy::kHold);
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep()[1], (WheelSpeeds{2, 2}));
}

TEST_F(DisconnectTest, StopStopsTheRobot) {
  Lose(LossPolicy::kStop);
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep()[1], (WheelSpeeds{0, 0}));
}

TEST_F(DisconnectTest, DropTakesTheRobotOut) {
  Lose(LossPolicy::kDrop);
  EXPECT_TRUE(board_.AllReady());
  EXPECT_TRUE(board_.Owners()[1].dropped);
}

TEST_F(DisconnectTest, StopActsAfterTheCommandThatIsStillPending) {
  RobotEntry lost = MakeRobot("robot1");
  lost.on_disconnect = LossPolicy::kStop;
  UseEntries({lost});
  board_.SetMode(Mode::kRealtime, now_);
  Client ended = ana_;
  ended.input_ended = true;
  board_.Command(slot("robot1"), ended, Wheels(4, 4), {}, Note("ana"));
  board_.Closed(slot("robot1"), ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{4, 4}));
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
}

/// Robot 1 drives at (2, 2) in a mode, and its client, with or without a name, is lost.
class DefaultLossTest : public CommandBoardTest {
 protected:
  void Drive(Mode mode, const Client& client) {
    UseRobots({"robot1"});
    board_.SetMode(mode, now_);
    board_.Command(slot("robot1"), client, Wheels(2, 2), {}, Note("client"));
    RunStep();
  }
  void Lose(Mode mode, const Client& client) {
    Drive(mode, client);
    board_.InputEnded(slot("robot1"), client.id);
    board_.Closed(slot("robot1"), client.id);
  }
  const Client nameless_{5, "", "127.0.0.1:5"};
};

TEST_F(DefaultLossTest, InRealtimeAndFreeARobotStopsWithTheProgramThatSaidHello) {
  for (const Mode mode : {Mode::kRealtime, Mode::kFree}) {
    Lose(mode, ana_);
    EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0})) << ToString(mode);
  }
}

TEST_F(DefaultLossTest, OneThatEndsWithoutAnEndOfItsInputStopsItToo) {
  Drive(Mode::kRealtime, ana_);
  board_.Closed(slot("robot1"), ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
}

TEST_F(DefaultLossTest, WithoutHelloTheSetpointsStay) {
  Lose(Mode::kRealtime, nameless_);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{2, 2}));
}

TEST_F(DefaultLossTest, AClientThatReleasedItsRobotLeavesTheSetpoints) {
  Drive(Mode::kRealtime, ana_);
  board_.Release(slot("robot1"), ana_);
  board_.Closed(slot("robot1"), ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{2, 2}));
}

TEST_F(DefaultLossTest, AnExplicitWaitLeavesTheSetpointsInRealtime) {
  RobotEntry waits = MakeRobot("robot1");
  waits.on_disconnect = LossPolicy::kWait;
  UseEntries({waits});
  board_.SetMode(Mode::kRealtime, now_);
  board_.Command(slot("robot1"), ana_, Wheels(2, 2), {}, Note("ana"));
  RunStep();
  board_.Closed(slot("robot1"), ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{2, 2}));
}

TEST_F(DefaultLossTest, ItStopsWhenWhatTheClientSentHasRun) {
  Drive(Mode::kRealtime, ana_);
  board_.Command(slot("robot1"), ana_, Wheels(3, 3), 2, Note("ana"));
  board_.Closed(slot("robot1"), ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{3, 3}));
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{3, 3}));
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
}

TEST_F(DefaultLossTest, LockstepWaitsForARobotThatStoppedInRealtime) {
  Lose(Mode::kRealtime, ana_);
  board_.SetMode(Mode::kLockstep, now_);
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(DefaultLossTest, LostInLockstepItStopsWhenTheModeIsSwitched) {
  Lose(Mode::kLockstep, ana_);
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
}

TEST_F(DefaultLossTest, LostInLockstepItKeepsWhatSomebodyElseCommandsMeanwhile) {
  Lose(Mode::kLockstep, ana_);
  board_.Command(slot("robot1"), nameless_, Wheels(1, 1), {}, Note("nameless"));
  RunStep();
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{1, 1}));
}

TEST_F(DefaultLossTest, ANewOwnerOfTheSameNameKeepsTheRobotMoving) {
  Drive(Mode::kRealtime, ana_);
  board_.Hello(slot("robot1"), {7, "ana", "127.0.0.1:7"});
  board_.Closed(slot("robot1"), ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{2, 2}));
}

TEST_F(DefaultLossTest, TheStopIsAnInputOfTheNextStep) {
  Lose(Mode::kRealtime, ana_);
  RunStep();
  ASSERT_EQ(board_.LatchedLosses().size(), 1u);
  EXPECT_EQ(board_.LatchedLosses()[0].robot, 0u);
  EXPECT_EQ(board_.LatchedLosses()[0].client, "ana");
  EXPECT_EQ(board_.LatchedLosses()[0].policy, LossPolicy::kStop);
  RunStep();
  EXPECT_TRUE(board_.LatchedLosses().empty());
}

TEST_F(DefaultLossTest, AClientThatStoppedItsRobotItselfChangesNothing) {
  Drive(Mode::kRealtime, ana_);
  board_.Command(slot("robot1"), ana_, Wheels(0, 0), {}, Note("ana"));
  board_.Closed(slot("robot1"), ana_.id);
  RunStep();
  RunStep();
  EXPECT_TRUE(board_.LatchedLosses().empty());
}

TEST_F(DefaultLossTest, StillMovingIsARobotThatNobodyDrivesAndWhoseSetpointsAreNotZero) {
  Drive(Mode::kRealtime, nameless_);
  EXPECT_FALSE(board_.Owners()[0].still_moving);
  board_.Closed(slot("robot1"), nameless_.id);
  EXPECT_TRUE(board_.Owners()[0].still_moving);
  board_.SetPlaying(true);
  EXPECT_FALSE(board_.Owners()[0].still_moving);
  board_.SetPlaying(false);
  board_.StopAll();
  EXPECT_FALSE(board_.Owners()[0].still_moving);
}

}  // namespace
}  // namespace coopdyn
