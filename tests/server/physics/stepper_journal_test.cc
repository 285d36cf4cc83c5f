// SPDX-License-Identifier: MIT
// The stepper's reports to the journal of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/physics/stepper_restore_fixture.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(StepperRestoreTest, TheJournalBeginsWithTheStateAndGetsEachStep) {
  Begin(true);
  Steps(2);
  Do(edit::SetJournal{&journal_});
  Steps(2);
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 2", "step 3 lockstep key 2", "step 4 lockstep"));
  EXPECT_THAT(journal_.asked, ElementsAre(3u, 4u));
  ASSERT_EQ(journal_.states.size(), 1u);
  EXPECT_EQ(journal_.states[0]->mode, Mode::kLockstep);
  EXPECT_FALSE(journal_.states[0]->controllers.empty());
  EXPECT_EQ(journal_.frames.back(), frames_.Latest());
}

TEST_F(StepperRestoreTest, AJournalTakenAwayGetsNothingMore) {
  Begin();
  Do(edit::SetJournal{&journal_});
  Do(edit::SetJournal{nullptr});
  Steps(2);
  Do(edit::Reset{});
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0"));
}

TEST_F(StepperRestoreTest, ResetLoadAndRestoreBeginTheJournalAnew) {
  Begin();
  Do(edit::SetJournal{&journal_});
  Steps(2);
  const SavedStatePtr saved = Save();
  Do(edit::Reset{3});
  Step();
  Do(edit::Restore{saved});
  Step();
  Do(edit::Load{Read(kRobots)});
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0", "step 1 lockstep", "step 2 lockstep", "begin 0",
                                           "step 1 lockstep", "begin 2", "step 3 lockstep key 0", "begin 0"));
  EXPECT_EQ(journal_.states[1]->frame->seed, 3u);
  EXPECT_EQ(journal_.states[2]->setpoints, saved->setpoints);
}

TEST_F(StepperRestoreTest, EditsAreInputsOfTheStepAfterWhichTheyCame) {
  Begin(true);
  Do(edit::SetJournal{&journal_});
  Step();
  journal_.Take();
  Do(edit::SetMode{Mode::kFree});
  Do(edit::SetStep{5'000'000});
  Do(edit::SetSpeed{2});
  Do(edit::SetMode{Mode::kLockstep});
  Do(edit::SetParticipants{{"robot1", "robot3"}});
  Do(edit::StopAll{});
  Do(edit::Pause{});
  Do(edit::Run{});
  Do(edit::UnloadController{"robot2"});
  Do(edit::Save{});
  EXPECT_THAT(journal_.Take(), ElementsAre("input 1 set_mode free", "input 1 set_step 0.005",
                                           HasSubstr("input 1 set_speed 2"), "input 1 set_mode lockstep",
                                           "input 1 set_participants robot1 robot3", "input 1 stop_all",
                                           "input 1 pause", "input 1 run", "input 1 release_robot robot2"));
}

TEST_F(StepperRestoreTest, RefusedEditsAreNoInputs) {
  Begin();
  Do(edit::SetJournal{&journal_});
  journal_.Take();
  EXPECT_NE(Do(edit::UnloadController{"nobody"}).error, Error::kOk);
  EXPECT_NE(Do(edit::SetParticipants{{"nobody"}}).error, Error::kOk);
  EXPECT_NE(Do(edit::Step{1}).error, Error::kOk);
  EXPECT_NE(Do(edit::Seek{}).error, Error::kOk);
  EXPECT_THAT(journal_.Take(), IsEmpty());
}

TEST_F(StepperRestoreTest, ADeadlineIsAnInputAndAnEvent) {
  Begin();
  Do(edit::SetJournal{&journal_});
  Step();
  journal_.Take();
  Keep("robot2");
  Keep("robot3");
  clock_.Advance(2 * kNanosecondsPerSecond);
  std::stop_source stop;
  board_.AddObserver([&stop](const FramePtr&) { stop.request_stop(); });
  stepper_->Run(stop.get_token());
  EXPECT_THAT(journal_.Take(),
              ElementsAre("input 1 deadline robot1 stop", "note 1 warning", "step 2 lockstep"));
}

TEST_F(StepperRestoreTest, AControllerThatStopsIsAnInputBeforeItsStep) {
  driver_.fails_after = 1;
  Begin(true);
  Do(edit::SetJournal{&journal_});
  Steps(3);
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0", "step 1 lockstep", "note 2 error",
                                           "input 1 controller_stopped robot2 controller count crashed",
                                           "step 2 lockstep", "step 3 lockstep key 2"));
}

TEST_F(StepperRestoreTest, AControllerThatStandsFromTheStartIsNoInput) {
  Begin(true);
  Do(edit::SetJournal{&journal_});
  Step();
  journal_.Take();
  driver_.fails_at_start = true;
  Do(edit::Reset{});
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0", "note 0 error"));
  EXPECT_EQ(journal_.states.back()->controllers.at(1), std::byte{1}) << "its state says so";
}

}  // namespace
}  // namespace coopdyn
