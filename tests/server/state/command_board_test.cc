// SPDX-License-Identifier: MIT
// The lockstep contract (docs/protocol.md) at the level of the board: no sockets, no threads, time as an
// argument.
#include <gtest/gtest.h>

#include "command_board_fixture.h"

namespace coopdyn {
namespace {

TEST_F(CommandBoardTest, AStepNeedsEveryParticipant) {
  EXPECT_FALSE(board_.AllReady());
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  EXPECT_FALSE(board_.AllReady());
  board_.Command(slot("robot2"), bob_, Wheels(2, 2), {}, Note("bob"));
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(CommandBoardTest, InLockstepTheReplyComesAfterTheStep) {
  EXPECT_FALSE(board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana")).answer_now);
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  EXPECT_TRUE(answers_.empty());
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{1, 1}));
  ASSERT_EQ(answers_["ana"].size(), 1u);
  EXPECT_EQ(answers_["ana"][0].end, StepEnd::kRan);
  EXPECT_EQ(answers_["ana"][0].frame->step, 1u);
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(CommandBoardTest, InRealtimeACommandIsAnsweredAtOnceAndReadyAfterTheStep) {
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_TRUE(board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("command")).answer_now);
  EXPECT_FALSE(board_.Ready(slot("robot1"), ana_, 1, Note("ready")).answer_now);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{1, 1}));  // ready did not undo the command
  EXPECT_EQ(answers_["command"].size(), 0u);
  EXPECT_EQ(answers_["ready"].size(), 1u);
}

TEST_F(CommandBoardTest, ReadyKeepsTheSetpoints) {
  board_.Command(slot("robot1"), ana_, Wheels(3, 4), {}, Note("ana"));
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  RunStep();
  board_.Ready(slot("robot1"), ana_, 1, Note("ana"));
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{3, 4}));
}

TEST_F(CommandBoardTest, ACommandForThreeStepsIsAnsweredAfterTheThird) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), 3, Note("ana"));
  board_.Ready(slot("robot2"), bob_, 3, Note("bob"));
  for (int k = 0; k < 2; ++k) {
    EXPECT_TRUE(board_.AllReady());
    RunStep();
    EXPECT_TRUE(answers_.empty());
  }
  RunStep();
  EXPECT_EQ(answers_["ana"].size(), 1u);
  EXPECT_EQ(answers_["bob"].size(), 1u);
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(CommandBoardTest, AGivenNumberOfStepsIsWaitedForInRealtimeToo) {
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_FALSE(board_.Command(slot("robot1"), ana_, Wheels(1, 1), 2, Note("ana")).answer_now);
  RunStep();
  EXPECT_TRUE(answers_.empty());
  RunStep();
  EXPECT_EQ(answers_["ana"].size(), 1u);
}

TEST_F(CommandBoardTest, ACommandDuringAStepCountsForTheNextOne) {
  board_.SetMode(Mode::kRealtime, now_);
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  board_.Latch(step_ + 1);
  board_.Command(slot("robot1"), ana_, Wheels(2, 2), {}, Note("ana"));
  board_.FinishStep(MakeFrame(++step_), now_);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{2, 2}));
}

TEST_F(CommandBoardTest, ASecondCommanderIsRefusedAndTheOwnerNamed) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  const Verdict verdict = board_.Command(slot("robot1"), bob_, Wheels(2, 2), {}, Note("bob"));
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_NE(verdict.text.find("ana"), std::string::npos);
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{1, 1}));
}

TEST_F(CommandBoardTest, ARefusedCommandMakesNobodyReady) {
  board_.Claim(slot("robot1"), ana_);
  board_.Command(slot("robot1"), bob_, Wheels(2, 2), {}, Note("bob"));
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(CommandBoardTest, HelloOfTheSameNameTakesOver) {
  board_.Claim(slot("robot1"), ana_);
  const Client again{7, "ana", "127.0.0.1:7"};
  EXPECT_EQ(board_.Hello(slot("robot1"), again).displaced, ana_.id);
  EXPECT_EQ(board_.Command(slot("robot1"), again, Wheels(1, 1), {}, Note("again")).error, Error::kOk);
  EXPECT_EQ(board_.Command(slot("robot1"), ana_, Wheels(2, 2), {}, Note("old")).error, Error::kOwned);
}

TEST_F(CommandBoardTest, HelloOfAnotherNameTakesNothing) {
  board_.Claim(slot("robot1"), ana_);
  EXPECT_EQ(board_.Hello(slot("robot1"), bob_).displaced, 0u);
  EXPECT_EQ(board_.Claim(slot("robot1"), bob_).error, Error::kOwned);
}

TEST_F(CommandBoardTest, ANewOwnersFirstCommandReplacesTheRestOfAnNStepCommand) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), 10, Note("ana"));
  board_.Ready(slot("robot2"), bob_, 10, Note("bob"));
  RunStep();
  board_.InputEnded(slot("robot1"), ana_.id);
  const Client cy{3, "cy", "127.0.0.1:3"};
  board_.Command(slot("robot1"), cy, Wheels(5, 5), {}, Note("cy"));
  ASSERT_EQ(answers_["ana"].size(), 1u);
  EXPECT_EQ(answers_["ana"][0].end, StepEnd::kReplaced);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{5, 5}));
  EXPECT_EQ(answers_["cy"].size(), 1u);
}

TEST_F(CommandBoardTest, EndOfInputFreesTheModuleAtOnceButWhatIsPendingRuns) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  board_.InputEnded(slot("robot1"), ana_.id);
  EXPECT_EQ(board_.Owners()[0].id, 0u);
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{1, 1}));
  EXPECT_EQ(answers_["ana"].size(), 1u);
}

TEST_F(CommandBoardTest, RequestsReadBeforeTheEndOfInputStillRunButOwnNothing) {
  Client ended = ana_;
  ended.input_ended = true;
  EXPECT_EQ(board_.Command(slot("robot1"), ended, Wheels(1, 1), {}, Note("ana")).error, Error::kOk);
  EXPECT_EQ(board_.Owners()[0].id, 0u);
  EXPECT_EQ(board_.Claim(slot("robot1"), bob_).error, Error::kOk);
  EXPECT_EQ(board_.Command(slot("robot1"), ended, Wheels(1, 1), {}, Note("ana")).error, Error::kOwned);
}

TEST_F(CommandBoardTest, AParticipantWithoutAClientIsWaitedFor) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  now_ = kSecond + kSecond / 5;
  std::size_t total = 0;
  const std::vector<Awaited> awaited = board_.Awaiting(now_, 20, &total);
  ASSERT_EQ(awaited.size(), 1u);
  EXPECT_EQ(total, 1u);
  EXPECT_EQ(awaited[0].robot, "robot2");
  EXPECT_EQ(awaited[0].why, "no client");
  EXPECT_NEAR(awaited[0].seconds, 1.2, 1e-9);
}

TEST_F(CommandBoardTest, AnOwnerWithoutCommandIsNamed) {
  board_.Claim(slot("robot1"), ana_);
  EXPECT_EQ(board_.Awaiting(now_, 20, nullptr)[0].why, "no command from ana");
}

TEST_F(CommandBoardTest, SpectatorsWaitButMakeNobodyReady) {
  board_.WaitSteps(2, Note("spectator"));
  EXPECT_FALSE(board_.AllReady());
  RunStep();
  EXPECT_TRUE(answers_.empty());
  RunStep();
  EXPECT_EQ(answers_["spectator"].size(), 1u);
}

TEST_F(CommandBoardTest, ObserversComeBeforeTheRepliesOfTheirStep) {
  std::vector<std::string> order;
  const std::uint64_t key = board_.AddObserver(
      [&](const FramePtr& frame) { order.push_back("push " + std::to_string(frame->step)); });
  board_.WaitSteps(
      1, [&](const StepResult& result) { order.push_back("reply " + std::to_string(result.frame->step)); });
  RunStep();
  board_.RemoveObserver(key);
  RunStep();
  EXPECT_EQ(order, (std::vector<std::string>{"push 1", "reply 1"}));
}

TEST_F(CommandBoardTest, TheHookIsCalledByWhoeverMakesTheLastRobotReady) {
  int calls = 0;
  board_.set_all_ready_hook([&] { ++calls; });
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  EXPECT_EQ(calls, 0);
  board_.Command(slot("robot2"), bob_, Wheels(1, 1), {}, Note("bob"));
  EXPECT_EQ(calls, 1);
}

TEST_F(CommandBoardTest, SyncNoIsNotWaitedFor) {
  RobotEntry free_robot = MakeRobot("robot2");
  free_robot.sync = false;
  UseEntries({MakeRobot("robot1"), free_robot});
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(CommandBoardTest, ParticipantsAreSetByNameAndAnEmptyListRestoresTheScenarios) {
  const std::vector<std::string> only{"robot2"};
  EXPECT_EQ(board_.SetParticipants(only, now_).error, Error::kOk);
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  EXPECT_TRUE(board_.AllReady());
  board_.SetParticipants({}, now_);
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(CommandBoardTest, AnUnknownParticipantChangesNothing) {
  const std::vector<std::string> wrong{"robot9"};
  const Verdict verdict = board_.SetParticipants(wrong, now_);
  EXPECT_EQ(verdict.error, Error::kNoSuchName);
  EXPECT_TRUE(verdict.text.starts_with("no robot is called robot9: there are robot1, robot2"))
      << verdict.text;
  board_.Ready(slot("robot1"), ana_, 1, Note("ana"));
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(CommandBoardTest, StopAllReplacesCommandsThatHaveNotRunAndTheyAreAnsweredAsUsual) {
  board_.Command(slot("robot1"), ana_, Wheels(9, 9), {}, Note("ana"));
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  board_.StopAll();
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
  EXPECT_EQ(answers_["ana"][0].end, StepEnd::kRan);
}

TEST_F(CommandBoardTest, ResetEndsAllWaitsAndKeepsOwners) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  board_.WaitSteps(3, Note("spectator"));
  const SlotId before = slot("robot1");
  UseRobots({"robot1", "robot2"}, StepEnd::kReset);
  EXPECT_EQ(answers_["ana"][0].end, StepEnd::kReset);
  EXPECT_EQ(answers_["spectator"][0].end, StepEnd::kReset);
  EXPECT_EQ(slot("robot1"), before);
  EXPECT_EQ(board_.Owners()[0].id, ana_.id);
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
}

TEST_F(CommandBoardTest, ResetKeepsTheChosenParticipants) {
  const std::vector<std::string> only{"robot2"};
  board_.SetParticipants(only, now_);
  UseRobots({"robot1", "robot2"}, StepEnd::kReset);
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(CommandBoardTest, ALoadKeepsRobotsOfTheSameNameAndForgetsOthers) {
  board_.Claim(slot("robot1"), ana_);
  const SlotId first = slot("robot1"), second = slot("robot2");
  UseRobots({"robot3", "robot1"});
  EXPECT_EQ(slot("robot1"), first);
  EXPECT_EQ(board_.Owners()[1].id, ana_.id);
  EXPECT_EQ(board_.Command(second, bob_, Wheels(1, 1), {}, Note("bob")).error, Error::kNotPossible);
}

TEST_F(CommandBoardTest, AModeSwitchLetsWaitingRequestsWait) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_TRUE(answers_.empty());
  RunStep();
  ASSERT_EQ(answers_["ana"].size(), 1u);
  EXPECT_EQ(answers_["ana"][0].mode, Mode::kRealtime);
}

TEST_F(CommandBoardTest, LockstepAwaitsTheModulesThatTheEntryListsAlone) {
  RobotEntry listed = MakeRobot("robot1"), other = MakeRobot("robot2");
  listed.waits_for = {"motors"};
  other.waits_for = {"arm"};  // none of its actuators
  UseEntries({listed, other});
  std::size_t total = 0;
  EXPECT_EQ(board_.Awaiting(now_, 9, &total).at(0).robot, "robot1");
  EXPECT_EQ(total, 1u);
}

TEST_F(CommandBoardTest, WhatToDoAboutARobotWithoutClientNamesTheOthers) {
  EXPECT_EQ(board_.Awaiting(now_, 9, nullptr)[0].cure, "start their programs, or set_mode realtime");
  board_.Claim(slot("robot1"), ana_);
  const std::vector<Awaited> awaited = board_.Awaiting(now_, 9, nullptr);
  EXPECT_EQ(awaited[0].cure, "") << "its program is there";
  EXPECT_NE(
      awaited[1].cure.find(
          "start its program, or let the others go on with set_participants robot1, or the page's button"),
      std::string::npos);
}

TEST_F(CommandBoardTest, EndStepsEndsStepNAloneAndTellsHowManyHaveRun) {
  board_.WaitSteps(9, Note("spectator"));
  board_.WaitSteps(5, Note("step 5"), 5);
  board_.WaitSteps(12, Note("step 7"), 7);  // after those five
  for (int k = 0; k < 3; ++k) RunStep();
  board_.EndSteps();
  ASSERT_EQ(answers_["step 5"].size(), 1u);
  EXPECT_EQ(answers_["step 5"][0].end, StepEnd::kPaused);
  EXPECT_EQ(answers_["step 5"][0].ran, 3);
  EXPECT_EQ(answers_["step 5"][0].asked, 5);
  EXPECT_EQ(answers_["step 7"][0].ran, 0);
  EXPECT_TRUE(answers_["spectator"].empty());
}

TEST_F(CommandBoardTest, StoppingEndsAllWaitsAndLaterOnesAtOnce) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  board_.Stop(MakeFrame(0), "the run has ended: why not");
  EXPECT_EQ(answers_["ana"][0].end, StepEnd::kStopping);
  board_.WaitSteps(1, Note("late"));
  EXPECT_EQ(answers_["late"][0].end, StepEnd::kStopping);
  EXPECT_EQ(answers_["late"][0].why, "the run has ended: why not");
  EXPECT_EQ(board_.Command(slot("robot2"), bob_, Wheels(1, 1), {}, Note("bob")).error, Error::kNotPossible);
}

TEST_F(CommandBoardTest, ConnectionsOfOnePartyActAsOneClient) {
  const Client requests{11, "", "a", false, false, "/ctl"}, stream{12, "", "b", false, false, "/ctl"};
  EXPECT_EQ(board_.Command(slot("robot1"), requests, Wheels(1, 1), {}, Note("requests")).error, Error::kOk);
  EXPECT_EQ(board_.Command(slot("robot1"), stream, Wheels(2, 2), {}, Note("stream")).error, Error::kOk);
  EXPECT_EQ(board_.Command(slot("robot1"), bob_, Wheels(3, 3), {}, Note("bob")).error, Error::kOwned);
  EXPECT_EQ(board_.OwnerOf(slot("robot1")), "/ctl");
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{2, 2}));
  EXPECT_EQ(answers_["requests"].at(0).end, StepEnd::kRan);
  EXPECT_EQ(answers_["stream"].at(0).end, StepEnd::kRan);
}

}  // namespace
}  // namespace coopdyn
