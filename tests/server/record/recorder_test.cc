// SPDX-License-Identifier: MIT
#include "server/record/recorder.h"

#include "recorder_fixture.h"
#include "server/record/record_queue.h"
#include "server/record/state_codec.h"

namespace coopdyn {
namespace {

TEST_F(RecorderTest, ARunIsRecordedFromBeginToClose) {
  Recorder recorder(Options(), clock_, NullLogger());
  EXPECT_EQ(recorder.Check(), "");
  recorder.Begin(maker_.Start());
  Steps(recorder, 1, 100, Mode::kLockstep);
  recorder.Input({100, edit::StopAll{}});
  recorder.Note({100, 1.0, "note", "here it is"});
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 101);
  EXPECT_EQ(Ask(file_, "SELECT step FROM input WHERE action = 'stop_all'"), 100);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event WHERE level = 'note'"), "here it is");
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
  EXPECT_EQ(AskText(file_, "SELECT value FROM meta WHERE key = 'build'").size(), 16U);
  const RecorderStatus status = recorder.status();
  EXPECT_EQ(status.file, file_);
  EXPECT_EQ(status.steps, 100U);
  EXPECT_EQ(status.lost, 0U);
  EXPECT_EQ(status.begin, 0);
  EXPECT_EQ(status.end, 1'000'000'000);
  EXPECT_EQ(status.bytes, std::filesystem::file_size(file_));
  EXPECT_EQ(status.failure, "");
  EXPECT_GT(status.cpu_s, 0);
}

TEST_F(RecorderTest, WithoutBeginNothingIsWritten) {
  {
    Recorder recorder(Options(), clock_, NullLogger());
    EXPECT_FALSE(recorder.WantsKeyframe(1));
    recorder.Step(maker_.Make(1), Mode::kLockstep, nullptr, 0);
    recorder.Note({1, 0.01, "info", "nobody hears"});
  }
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(RecorderTest, KeyframesComeAtTheStartAndEverySoManySteps) {
  RecorderOptions options = Options();
  options.keyframe_steps = 50;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start(7));
  Steps(recorder, 8, 157, Mode::kLockstep);
  recorder.Close();
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM keyframe"), "7,57,107,157");
}

TEST_F(RecorderTest, AKeyframeHasTheControllersTheScoresAndTheMode) {
  RecorderOptions options = Options();
  options.keyframe_steps = 1;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  const auto frame = maker_.Make(1);
  ASSERT_TRUE(recorder.WantsKeyframe(1));
  const auto exact = std::make_shared<SavedState>();
  exact->frame = frame;
  exact->controllers = {std::byte{42}};
  exact->scores = {1.5, 2};
  exact->mode = Mode::kFree;
  recorder.Step(frame, Mode::kFree, exact, 0);
  recorder.Close();
  std::string error;
  const auto database = Database::Open(file_, Database::Access::kReadOnly, error);
  Statement row = database->Prepare("SELECT state FROM keyframe WHERE step = 1");
  ASSERT_TRUE(row.Step());
  const SavedStatePtr state = DecodeState(row.blob(0), maker_.scene());
  ASSERT_NE(state, nullptr);
  EXPECT_EQ(state->controllers, std::vector<std::byte>{std::byte{42}});
  EXPECT_EQ(state->scores, (std::vector<double>{1.5, 2}));
  EXPECT_EQ(state->mode, Mode::kFree);
  EXPECT_EQ(StateHash(*state->frame), StateHash(*frame));
}

TEST_F(RecorderTest, ItCommitsLongBeforeARunHasToWait) {
  EXPECT_LE(RecorderOptions().commit_every, CrashCost().age / 2);
}

TEST_F(RecorderTest, WhatIsOlderThanTheCommitIntervalIsSafe) {
  RecorderOptions options = Options();
  options.commit_every = 200'000'000;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kRealtime);
  while (recorder.status().steps < 1) std::this_thread::yield();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 1);
  clock_.Advance(200'000'000);  // no more steps: the recorder checks the clock on its own
  while (Ask(file_, "SELECT count(*) FROM step") < 2) std::this_thread::yield();
  recorder.Close();
}

}  // namespace
}  // namespace coopdyn
