// SPDX-License-Identifier: MIT
// A recorder while its disk is too slow.
#include <atomic>
#include <future>

#include "recorder_fixture.h"

namespace coopdyn {
namespace {

TEST_F(RecorderTest, InLockstepAFullQueueSlowsTheRunAndNothingIsLost) {
  Recorder recorder(WithRoomFor(3), clock_, NullLogger());
  BeginAndHold(recorder, Mode::kLockstep);
  std::atomic<std::uint64_t> stepped{1};
  std::promise<void> full;
  auto run = std::async(std::launch::async, [&] {
    for (std::uint64_t step = 2; step <= 50; ++step) {
      Step(recorder, step, Mode::kLockstep);
      stepped = step;
      if (step == 4) full.set_value();
    }
  });
  full.get_future().wait();
  EXPECT_LE(stepped, 4U);  // the fifth waits for room
  clock_.OpenGate();
  run.get();
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 51);
  EXPECT_EQ(recorder.status().lost, 0U);
}

TEST_F(RecorderTest, DurableAStepIsAnsweredWhenItIsCommitted) {
  RecorderOptions options = Options();
  options.durable = true;
  options.commit_every = kNanosecondsPerSecond;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  for (std::uint64_t step = 1; step <= 20; ++step) {
    Step(recorder, step, step % 2 == 0 ? Mode::kLockstep : Mode::kFree);
    EXPECT_EQ(Ask(file_, "SELECT max(step) FROM step"), static_cast<std::int64_t>(step));
  }
}

TEST_F(RecorderTest, InRealTimeAFullQueueLosesStepsAndTheNextIsAKeyframe) {
  Recorder recorder(WithRoomFor(4), clock_, NullLogger());
  BeginAndHold(recorder, Mode::kRealtime);
  Steps(recorder, 2, 11, Mode::kRealtime);
  EXPECT_EQ(recorder.status().lost, 6U);
  EXPECT_FALSE(recorder.WantsKeyframe(12));  // there is no room for it yet
  recorder.Input({11, edit::StopAll{}});     // is never lost
  clock_.OpenGate();
  while (!recorder.WantsKeyframe(12)) std::this_thread::yield();
  Step(recorder, 12, Mode::kRealtime);
  Step(recorder, 13, Mode::kRealtime);
  recorder.Close();
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM step"), "0,1,2,3,4,5,12,13");
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM keyframe"), "0,12");
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost'"), 6);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event WHERE level = 'warning' AND step = 12"),
            "6 steps were not recorded: the disk did not keep up");
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM input"), 1);
}

TEST_F(RecorderTest, StepsLostAtTheEndAreSaidToo) {
  Recorder recorder(WithRoomFor(1), clock_, NullLogger());
  BeginAndHold(recorder, Mode::kRealtime);
  Steps(recorder, 2, 3, Mode::kRealtime);
  clock_.OpenGate();
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost'"), 1);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event"), "1 step was not recorded: the disk did not keep up");
}

TEST_F(RecorderTest, ALockstepRunWaitingForRoomIsReleasedByAFailure) {
  // The second file cannot be made: with its journal's suffix its name is too long.
  RecorderOptions options = WithRoomFor(1);
  const std::string name(243, 'x');
  options.file = folder_.File(name + ".run");
  std::atomic<int> failures{0};
  std::string said;
  options.on_failure = [&](const std::string& text) {
    said = text;
    ++failures;
  };
  Recorder recorder(options, clock_, NullLogger());
  BeginAndHold(recorder, Mode::kLockstep);
  auto run = std::async(std::launch::async, [&] {
    recorder.Begin(maker_.Start());
    Steps(recorder, 1, 50, Mode::kLockstep);
  });
  clock_.OpenGate();
  run.get();
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(failures, 1);
  EXPECT_NE(said.find(name + "-2.run"), std::string::npos) << said;
  EXPECT_EQ(recorder.status().failure, said);
  EXPECT_EQ(recorder.status().file, options.file);
  EXPECT_EQ(Ask(options.file, "SELECT value FROM meta WHERE key = 'closed'"), 1);
}

}  // namespace
}  // namespace coopdyn
