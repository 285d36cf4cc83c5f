// SPDX-License-Identifier: MIT
// The participants of a lockstep world, and how long it waits for them; the tests control the clock.
#include <gtest/gtest.h>

#include "command_board_fixture.h"

namespace coopdyn {
namespace {

constexpr Nanoseconds kMs = 1'000'000;

class CommandBoardWaitsTest : public CommandBoardTest {
 protected:
  CommandBoardWaitsTest() {
    clock_.Advance(kSecond);
    board_.MeasureWaits(clock_);
  }

  void Command(const std::string& robot, const Client& client) {
    board_.Command(slot(robot), client, Wheels(1, 1), {}, Note(robot));
  }
  /// A step for which ana's robot1 and bob's robot2 take this long.
  void StepAfter(Nanoseconds ana, Nanoseconds bob) {
    clock_.Advance(ana);
    Command("robot1", ana_);
    clock_.Advance(bob - ana);
    Command("robot2", bob_);
    RunStep();
  }

  ManualClock clock_;
};

TEST_F(CommandBoardWaitsTest, EachRobotIsWaitedForFromTheEndOfTheStepToItsCommand) {
  StepAfter(0, 0);
  StepAfter(1 * kMs, 4 * kMs);
  StepAfter(1 * kMs, 6 * kMs);
  const CommandBoard::Waits waits = board_.waits();
  ASSERT_EQ(waits.robots.size(), 2u);
  EXPECT_EQ(waits.robots[0].robot, "robot1");
  EXPECT_EQ(waits.robots[0].client, "ana");
  EXPECT_EQ(waits.robots[0].waited, 2 * kMs);
  EXPECT_EQ(waits.robots[1].waited, 10 * kMs);
  EXPECT_EQ(waits.total, 10 * kMs);
}

TEST_F(CommandBoardWaitsTest, TheLastOneAloneHoldsUpTheWorldFromThenOn) {
  StepAfter(0, 0);
  StepAfter(1 * kMs, 4 * kMs);
  const CommandBoard::Waits waits = board_.waits();
  EXPECT_EQ(waits.robots[0].alone, 0);
  EXPECT_EQ(waits.robots[1].alone, 3 * kMs);
}

TEST_F(CommandBoardWaitsTest, TheWaitForTheFirstCommandDoesNotCount) {
  StepAfter(1 * kMs, 30 * kSecond);
  EXPECT_EQ(board_.waits().total, 0);
}

TEST_F(CommandBoardWaitsTest, TellingWhoWaitedIsNoWaitForAClient) {
  board_.AddObserver([this](const FramePtr&) { clock_.Advance(9 * kMs); });
  StepAfter(0, 0);
  StepAfter(1 * kMs, 4 * kMs);
  EXPECT_EQ(board_.waits().total, 4 * kMs);
}

TEST_F(CommandBoardWaitsTest, ARobotThatIsReadyBeforeAllAreToldIsNotWaitedFor) {
  StepAfter(0, 0);
  board_.AddObserver([this](const FramePtr&) { Command("robot1", ana_); });
  StepAfter(1 * kMs, 4 * kMs);
  clock_.Advance(2 * kMs);
  Command("robot2", bob_);
  const CommandBoard::Waits waits = board_.waits();
  EXPECT_EQ(waits.robots[0].waited, 1 * kMs);
  EXPECT_EQ(waits.robots[1].waited, 6 * kMs);
  EXPECT_EQ(waits.robots[1].alone, 5 * kMs);
}

TEST_F(CommandBoardWaitsTest, APauseDoesNotCount) {
  StepAfter(0, 0);
  board_.IgnoreWait();
  StepAfter(1 * kMs, 30 * kSecond);
  EXPECT_EQ(board_.waits().total, 0);
}

TEST_F(CommandBoardWaitsTest, NobodyIsWaitedForInOtherModes) {
  StepAfter(0, 0);
  board_.SetMode(Mode::kRealtime, now_);
  StepAfter(1 * kMs, 4 * kMs);
  EXPECT_TRUE(board_.waits().robots.empty());
}

TEST_F(CommandBoardWaitsTest, AResetBeginsAnew) {
  StepAfter(0, 0);
  StepAfter(1 * kMs, 4 * kMs);
  UseRobots({"robot1", "robot2"}, StepEnd::kReset);
  EXPECT_TRUE(board_.waits().robots.empty());
  EXPECT_EQ(board_.waits().total, 0);
}

TEST_F(CommandBoardWaitsTest, AnEditOfTheWorldLeavesEachRobotItsOwn) {
  StepAfter(0, 0);
  StepAfter(1 * kMs, 4 * kMs);
  auto scenario = std::make_shared<Scenario>();
  scenario->robots = {MakeRobot("robot2")};
  scene_ = MakeScene(std::move(scenario));
  board_.Revise(*scene_, {}, MakeFrame(step_), now_);
  ASSERT_EQ(board_.waits().robots.size(), 1u);
  EXPECT_EQ(board_.waits().robots[0].robot, "robot2");
  EXPECT_EQ(board_.waits().robots[0].waited, 4 * kMs);
}

TEST_F(CommandBoardWaitsTest, ATeamIsReadyAtOnce) {
  const Client team{3, "carol", "127.0.0.1:3", false, true};
  const std::vector<SlotId> slots{slot("robot1"), slot("robot2")};
  for (int k = 0; k < 2; ++k) {
    clock_.Advance(5 * kMs);
    board_.StepAll({slots, {}}, team, 1, Note("carol"));
    RunStep();
  }
  const CommandBoard::Waits waits = board_.waits();
  ASSERT_EQ(waits.robots.size(), 2u);
  EXPECT_TRUE(waits.robots[0].is_team);
  EXPECT_EQ(waits.robots[0].waited, 5 * kMs);
  EXPECT_EQ(waits.robots[0].alone + waits.robots[1].alone, 5 * kMs);
  EXPECT_EQ(waits.total, 5 * kMs);
}

/// A world that waits only for the program /ctl.
class WaitsForProgramTest : public CommandBoardTest {
 protected:
  WaitsForProgramTest() {
    auto scenario = std::make_shared<Scenario>();
    scenario->robots = {MakeRobot("robot1")};
    scenario->robots[0].sync = false;
    scenario->simulation.waits_for = {"/ctl"};
    scene_ = MakeScene(std::move(scenario));
    board_.set_all_ready_hook([this] { ++hooks_; });
    board_.Configure(*scene_, StepEnd::kLoad, MakeFrame(0), now_);
  }
  std::string Why() {
    const std::vector<Awaited> awaited = board_.Awaiting(now_, 5, nullptr);
    return awaited.empty() ? "" : awaited[0].robot + " " + awaited[0].why;
  }

  int hooks_ = 0;
};

TEST_F(WaitsForProgramTest, ItMustReadSomething) {
  EXPECT_FALSE(board_.AllReady());
  EXPECT_EQ(Why(), "/ctl it reads none of our ports by tcp or text_ack");
  board_.NoteSampleTaken(1, "/ctlother/in", 0, 1);
  EXPECT_FALSE(board_.AllReady());
  board_.NoteSampleTaken(2, "/ctl/in", 0, 1);
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(hooks_, 1);
}

TEST_F(WaitsForProgramTest, AllItsReadersMustHaveTheSampleOfTheLastStep) {
  board_.NoteSampleTaken(1, "/ctl/a", 0, 1);
  board_.NoteSampleTaken(2, "/ctl/b", 0, 1);
  RunStep();
  board_.NoteSampleTaken(1, "/ctl/a", 1, 1);
  EXPECT_FALSE(board_.AllReady());
  EXPECT_EQ(Why(), "/ctl /ctl/b has not taken the sample of step 1");
  board_.NoteSampleTaken(2, "/ctl/b", 1, 1);
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(WaitsForProgramTest, AReaderOfEveryTenthStepIsWaitedForThen) {
  board_.NoteSampleTaken(1, "/ctl/a", 0, 10);
  for (int i = 0; i < 9; ++i) {
    RunStep();
    EXPECT_TRUE(board_.AllReady()) << step_;
  }
  RunStep();
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(WaitsForProgramTest, ItIsWaitedForAgainWhenItHasGone) {
  board_.NoteSampleTaken(1, "/ctl/a", 0, 1);
  board_.ForgetReader(1);
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(WaitsForProgramTest, AReaderMayBeFasterThanTheEndOfAStep) {
  board_.NoteSampleTaken(1, "/ctl/a", 0, 1);
  board_.NoteSampleTaken(1, "/ctl/a", 1, 1);  // frame 1 is published, but the board has not been notified
  RunStep();
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(WaitsForProgramTest, AReaderIsWaitedForFromItsFirstSampleOn) {
  RunStep();
  board_.NoteSampleTaken(1, "/ctl/a", 0, 1);  // step 1 ended before its samples arrived
  EXPECT_TRUE(board_.AllReady());
  RunStep();
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(WaitsForProgramTest, WhenOneOfItsReadersHasGoneTheOthersSuffice) {
  board_.NoteSampleTaken(1, "/ctl/a", 0, 1);
  board_.NoteSampleTaken(2, "/ctl/b", 0, 1);
  RunStep();
  board_.NoteSampleTaken(1, "/ctl/a", 1, 1);
  hooks_ = 0;
  board_.ForgetReader(2);
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(hooks_, 1);
}

TEST_F(WaitsForProgramTest, StepsBeforeAResetCountForNothing) {
  board_.NoteSampleTaken(1, "/ctl/a", 0, 1);
  for (int i = 0; i < 7; ++i) RunStep();
  board_.NoteSampleTaken(1, "/ctl/a", 6, 1);
  step_ = 0;
  board_.Configure(*scene_, StepEnd::kReset, MakeFrame(0), now_);
  EXPECT_TRUE(board_.AllReady());
  RunStep();
  EXPECT_FALSE(board_.AllReady());
  board_.NoteSampleTaken(1, "/ctl/a", 7, 1);  // on its way since before the reset
  EXPECT_FALSE(board_.AllReady());
  board_.NoteSampleTaken(1, "/ctl/a", 1, 1);
  EXPECT_TRUE(board_.AllReady());
}

}  // namespace
}  // namespace coopdyn
