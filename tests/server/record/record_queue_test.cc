// SPDX-License-Identifier: MIT
// The queue of the recorder, and the threads that wait for it.
#include "server/record/record_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include "record_fixture.h"

namespace coopdyn {
namespace {

class RecordQueueTest : public ::testing::Test {
 protected:
  SavedStatePtr StartIn(Mode mode) {
    SavedState state = *maker_.Start();
    state.mode = mode;
    return std::make_shared<const SavedState>(std::move(state));
  }
  /// Records several files, each with a run of a few steps.
  std::jthread Begin(int files) {
    return std::jthread([this, files] {
      for (int i = 0; i < files; ++i) {
        queue_.PushBegin({StartIn(Mode::kFree)});
        ++begun_;
      }
    });
  }

  /// Adds step `step` of the run, at `now`, on a separate thread; completes when the step may be answered.
  std::future<void> Step(std::uint64_t step, Nanoseconds now, Mode mode = Mode::kLockstep) {
    return std::async(std::launch::async, [this, now, mode, frame = FramePtr(maker_.Make(step))] {
      queue_.PushStep({frame, mode, nullptr, now});
    });
  }
  /// Whether it still waits after many chances to continue.
  static bool Waits(const std::future<void>& step) {
    for (int i = 0; i < 1000; ++i) std::this_thread::yield();
    return step.wait_for(std::chrono::seconds(0)) == std::future_status::timeout;
  }
  void Take(int items) {
    for (int i = 0; i < items; ++i) EXPECT_TRUE(queue_.Pop(false));
  }

  FrameMaker maker_{RecordScene()};
  RecordQueue queue_{std::size_t{1} << 30};
  std::atomic<int> begun_{0};
};

TEST_F(RecordQueueTest, AFileThatHasNotBegunIsWaitedForBeforeTheNext) {
  const std::jthread run = Begin(20);
  for (int taken = 0; taken < 20; ++taken) {
    while (begun_ < taken) std::this_thread::yield();
    EXPECT_TRUE(queue_.Pop(true));
    for (int i = 0; i < 1000; ++i) std::this_thread::yield();  // without a wait another would begin
    EXPECT_LE(begun_, taken + 1) << "the one in hand: the recorder has not come back for more";
  }
}

class CrashCostTest : public RecordQueueTest {
 protected:
  CrashCostTest() {
    queue_.PushBegin({StartIn(Mode::kLockstep)});
    Take(1);
    queue_.NoteCommitted();
  }
  static constexpr Nanoseconds kAge = CrashCost().age;
};

TEST_F(CrashCostTest, AThousandAnsweredStepsAtMostAreNotCommitted) {
  std::uint64_t step = 0;
  while (step < CrashCost().steps) Step(++step, 0).get();
  Take(700);
  std::future<void> next = Step(++step, 0);
  EXPECT_TRUE(Waits(next)) << "taken is not committed";
  queue_.NoteCommitted();
  next.get();
  while (step < 700 + CrashCost().steps) Step(++step, 0).get();
  next = Step(++step, 0);
  EXPECT_TRUE(Waits(next));
  queue_.Close();
  next.get();
}

TEST_F(CrashCostTest, NoStepIsAnsweredWhileAnOldOneIsNotCommitted) {
  Step(1, 0).get();
  Step(2, kAge).get();
  std::future<void> next = Step(3, kAge + 1);
  Take(1);
  EXPECT_TRUE(Waits(next));
  queue_.NoteCommitted();
  next.get();
  next = Step(4, 2 * kAge + 1);
  EXPECT_TRUE(Waits(next)) << "step 2 is too old now";
  queue_.Stall(0);
  next.get();
  Step(5, 9 * kAge).get();  // nothing is being recorded
}

TEST_F(CrashCostTest, InRealTimeNoStepWaits) {
  for (std::uint64_t step = 1; step <= 2 * CrashCost().steps; ++step)
    Step(step, static_cast<Nanoseconds>(step) * kAge, Mode::kRealtime).get();
  const std::future<void> next = Step(9999, 9999 * kAge);  // as others do
  EXPECT_TRUE(Waits(next));
  queue_.Fail();
}

TEST_F(RecordQueueTest, InRealTimeNobodyWaits) {
  for (int i = 0; i < 3; ++i) queue_.PushBegin({StartIn(Mode::kRealtime)});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(queue_.Pop(false));
}

TEST_F(RecordQueueTest, WhoWaitsForAFileToBeginIsReleasedByAFailure) {
  std::jthread run = Begin(2);
  while (begun_ < 1) std::this_thread::yield();
  queue_.Fail();
  run.join();
  EXPECT_EQ(begun_, 2);
  EXPECT_FALSE(queue_.Pop(false));
}

}  // namespace
}  // namespace coopdyn
