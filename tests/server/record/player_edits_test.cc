// SPDX-License-Identifier: MIT
// Effects of edits on a playback, and refused edits.
#include "tests/server/record/player_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

class PlayerEditsTest : public PlayerFixture {
 protected:
  void RecordPaused() { Record({}, {.paused = true}); }
  /// Pushes `step`; returns where its result will be stored.
  std::shared_ptr<std::optional<StepResult>> PushStep(int steps) {
    auto result = std::make_shared<std::optional<StepResult>>();
    edits_.Push({edit::Step{steps}, nullptr, [result](const StepResult& end) { *result = end; }});
    return result;
  }
  static Nanoseconds TimeOf(int step) { return step * SampleRun::kStep; }
};

TEST_F(PlayerEditsTest, RunAndPausePlayAndHold) {
  RecordPaused();
  EXPECT_EQ(Do(edit::Run{})->error, Error::kOk);
  EXPECT_EQ(control_.status().state, RunState::kPlaying);
  RunUntil(now_ + 55 * kMs);
  EXPECT_EQ(step(), 5u);
  EXPECT_EQ(Do(edit::Pause{})->frame->step, 5u);
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ(step(), 5u);
  EXPECT_EQ(control_.status().real_time_factor, 0);
  Do(edit::Run{});
  RunUntil(now_ + 10 * kMs);
  EXPECT_EQ(step(), 6u) << "it goes on from where it stood";
}

TEST_F(PlayerEditsTest, RunAtTheEndBeginsAgain) {
  Record({});
  RunUntil(now_ + 500 * kMs);
  ASSERT_EQ(step(), 20u);
  Do(edit::Run{});
  EXPECT_EQ(step(), 0u);
  RunUntil(now_ + 30 * kMs);
  EXPECT_EQ(step(), 3u);
}

TEST_F(PlayerEditsTest, SeekShowsTheStepAtOrBeforeTheTime) {
  RecordPaused();
  const auto answer = Do(edit::Seek{TimeOf(12) + 5});
  EXPECT_EQ(answer->error, Error::kOk);
  EXPECT_EQ(answer->frame->step, 12u);
  EXPECT_EQ(step(), 12u);
  EXPECT_EQ(frames_.Latest()->epoch, 2u);
  EXPECT_EQ(control_.playback()->step, 12u);
}

TEST_F(PlayerEditsTest, SeekOutsideShowsTheNearestEnd) {
  RecordPaused();
  EXPECT_EQ(Do(edit::Seek{TimeOf(1000)})->frame->step, 20u);
  EXPECT_EQ(Do(edit::Seek{-5})->frame->step, 0u);
}

TEST_F(PlayerEditsTest, SeekWhilePlayingGoesOnFromThere) {
  Record({});
  RunUntil(now_ + 20 * kMs);
  Do(edit::Seek{TimeOf(10)});
  RunUntil(now_ + 30 * kMs);
  EXPECT_EQ(step(), 13u);
}

TEST_F(PlayerEditsTest, SkipGoesRecordedStepsAndStands) {
  Record({});
  RunUntil(now_ + 50 * kMs);
  EXPECT_EQ(Do(edit::Skip{3})->frame->step, 8u);
  EXPECT_FALSE(control_.playback()->playing);
  EXPECT_EQ(Do(edit::Skip{-7})->frame->step, 1u);
  EXPECT_EQ(Do(edit::Skip{-7})->frame->step, 0u);
  EXPECT_EQ(Do(edit::Skip{1'000'000'000})->frame->step, 20u);
}

TEST_F(PlayerEditsTest, SkipCountsStepsThatAreThere) {
  Record({.lost_from = 5, .lost_to = 9}, {.paused = true});
  EXPECT_EQ(Do(edit::Skip{6})->frame->step, 11u);
  EXPECT_EQ(Do(edit::Skip{-2})->frame->step, 4u);
}

TEST_F(PlayerEditsTest, ResetJumpsToTheStartAndPlaysOn) {
  Record({});
  RunUntil(now_ + 55 * kMs);
  EXPECT_EQ(Do(edit::Reset{})->frame->step, 0u);
  RunUntil(now_ + 20 * kMs);
  EXPECT_EQ(step(), 2u);
  EXPECT_EQ(frames_.Latest()->epoch, 2u);
}

TEST_F(PlayerEditsTest, ResetWithAnotherSeedIsRefused) {
  RecordPaused();
  EXPECT_EQ(Do(edit::Reset{99})->error, Error::kNotPossible);
  EXPECT_EQ(Do(edit::Reset{7})->error, Error::kOk);
}

TEST_F(PlayerEditsTest, StepIsAnsweredAfterItsLastFrame) {
  RecordPaused();
  const auto result = PushStep(3);
  RunUntil(now_ + 25 * kMs);
  EXPECT_EQ(step(), 2u);
  EXPECT_FALSE(*result);
  RunUntil(now_ + 10 * kMs);
  EXPECT_EQ(step(), 3u);
  ASSERT_TRUE(*result);
  EXPECT_EQ((*result)->end, StepEnd::kRan);
  EXPECT_EQ((*result)->frame->step, 3u);
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ(step(), 3u);
}

TEST_F(PlayerEditsTest, StepsAddUp) {
  RecordPaused();
  const auto first = PushStep(2), second = PushStep(3);
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ((*first)->frame->step, 2u);
  EXPECT_EQ((*second)->frame->step, 5u);
}

TEST_F(PlayerEditsTest, StepWhilePlayingIsRefused) {
  Record({});
  const auto answer = Do(edit::Step{1});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->error, Error::kNotPossible);
  EXPECT_EQ(answer->text, "step works only while paused: send pause first");
}

TEST_F(PlayerEditsTest, StepsBeyondTheEndAreAnsweredThere) {
  RecordPaused();
  Do(edit::Seek{TimeOf(18)});
  const auto result = PushStep(10);
  RunUntil(now_ + 500 * kMs);
  ASSERT_TRUE(*result);
  EXPECT_EQ((*result)->frame->step, 20u);
  EXPECT_EQ(last_event(), "info: the recording has ended");
  EXPECT_EQ(wake_, kNever);
}

TEST_F(PlayerEditsTest, AJumpUndoesStepsThatWait) {
  RecordPaused();
  const auto result = PushStep(10);
  Do(edit::Reset{});
  ASSERT_TRUE(*result);
  EXPECT_EQ((*result)->end, StepEnd::kReset);
}

TEST_F(PlayerEditsTest, SpeedChangesFromWhereItIs) {
  Record({});
  RunUntil(now_ + 50 * kMs);
  EXPECT_EQ(Do(edit::SetPlaySpeed{-1})->error, Error::kOk);
  RunUntil(now_ + 25 * kMs);
  EXPECT_EQ(step(), 2u);
  EXPECT_EQ(control_.playback()->speed, -1);
  Do(edit::SetPlaySpeed{0.5});
  RunUntil(now_ + 45 * kMs);
  EXPECT_EQ(step(), 4u);
}

TEST_F(PlayerEditsTest, SpeedsThatCannotBeAreRefused) {
  RecordPaused();
  for (const double factor : {0.0, -4.1, 64.5, std::nan(""), HUGE_VAL}) {
    const auto answer = Do(edit::SetPlaySpeed{factor});
    EXPECT_EQ(answer->error, Error::kOutOfRange) << factor;
  }
  EXPECT_EQ(control_.playback()->speed, 1);
}

TEST_F(PlayerEditsTest, LoopCanBeChosenWhileItPlays) {
  Record({.steps = 3});
  Do(edit::SetLoop{true});
  EXPECT_TRUE(control_.playback()->loop);
  RunUntil(now_ + 45 * kMs);
  EXPECT_EQ(step(), 0u);
}

TEST_F(PlayerEditsTest, WhatWouldChangeTheRunIsRefused) {
  RecordPaused();
  const EditAction actions[] = {edit::Load{sample_.scenario()},    edit::SetMode{Mode::kFree},
                                edit::SetStep{SampleRun::kStep},   edit::SetSpeed{2},
                                edit::SetParticipants{{"robot1"}}, edit::StopAll{},
                                edit::UnloadController{"robot1"},  edit::Save{}};
  for (const EditAction& action : actions) {
    const auto answer = Do(action);
    ASSERT_TRUE(answer) << action.index();
    EXPECT_EQ(answer->error, Error::kNotPossible) << action.index();
    EXPECT_EQ(answer->text, kPlayingText);
    EXPECT_NE(answer->frame, nullptr);
  }
}

TEST_F(PlayerEditsTest, NoJournalIsTakenButItsAbsenceIsFine) {
  RecordPaused();
  EXPECT_EQ(Do(edit::SetJournal{nullptr})->error, Error::kOk);
}

TEST_F(PlayerEditsTest, RestoreEndsThePlayback) {
  RecordPaused();
  const auto step = PushStep(5);
  RunUntil(now_);
  edits_.Push({edit::Restore{std::make_shared<SavedState>(sample_.StateAt(4))}, nullptr});
  edits_.Push({edit::Run{}, nullptr});
  RunUntil(now_);
  ASSERT_TRUE(ended_by_);
  EXPECT_EQ(As<edit::Restore>(ended_by_->action)->state->frame->step, 4u);
  EXPECT_FALSE(control_.playback());
  EXPECT_EQ((*step)->end, StepEnd::kLoad);
  EXPECT_EQ(edits_.TakeAll().size(), 1u) << "what came after it is for the live run";
  const Client ana{1, "ana", "a"};
  const Verdict verdict = board_.Command(board_.FindSlot("robot1"), ana, Wheels(1, 1), {}, nullptr);
  EXPECT_EQ(verdict.error, Error::kOk) << "robots can be driven again";
}

TEST_F(PlayerEditsTest, WhatComesAfterARestoreStaysInOrderForTheLiveRun) {
  RecordPaused();
  // While the first of them is applied here, another one arrives.
  edits_.Push({edit::SetLoop{true}, [this](const EditResult&) {
                 edits_.Push({edit::Note{"late"}, nullptr});
               }});
  edits_.Push({edit::Restore{std::make_shared<SavedState>(sample_.StateAt(4))}, nullptr});
  edits_.Push({edit::Note{"early"}, nullptr});
  RunUntil(now_);
  ASSERT_TRUE(ended_by_);
  std::vector<std::string> notes;
  for (const Edit& edit : edits_.TakeAll()) notes.push_back(As<edit::Note>(edit.action)->text);
  EXPECT_EQ(notes, (std::vector<std::string>{"early", "late"}));
}

TEST_F(PlayerEditsTest, PauseEndsStepNAndTellsHowManyWereShown) {
  RecordPaused();
  const auto first = PushStep(10), second = PushStep(5);
  RunUntil(now_ + 35 * kMs);
  Do(edit::Pause{});
  ASSERT_TRUE(*first && *second);
  EXPECT_EQ((*first)->end, StepEnd::kPaused);
  EXPECT_EQ((*first)->ran, 3);
  EXPECT_EQ((*first)->asked, 10);
  EXPECT_EQ((*second)->ran, 0);
  const std::uint64_t shown = step();
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ(step(), shown);
}

TEST_F(PlayerEditsTest, NobodyDrives) {
  RecordPaused();
  const Client ana{1, "ana", "a"};
  const Verdict verdict = board_.Command(board_.FindSlot("robot1"), ana, Wheels(1, 1), {}, nullptr);
  EXPECT_EQ(verdict.error, Error::kNotPossible);
  EXPECT_EQ(verdict.text, kPlayingText);
}

TEST_F(PlayerEditsTest, ReadyIsAnsweredWithTheNextFrameShown) {
  RecordPaused();
  const Client ana{1, "ana", "a"};
  std::optional<StepResult> answer;
  board_.Ready(board_.FindSlot("robot1"), ana, 1, [&](const StepResult& result) { answer = result; });
  RunUntil(now_ + 100 * kMs);
  EXPECT_FALSE(answer);
  Do(edit::Seek{TimeOf(9)});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->frame->step, 9u);
  EXPECT_EQ(answer->end, StepEnd::kRan);
}

}  // namespace
}  // namespace coopdyn
