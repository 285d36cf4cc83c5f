// SPDX-License-Identifier: MIT
// What waits to be recorded, and who waits for it.
#include "server/record/record_queue.h"

#include <gtest/gtest.h>

#include <atomic>
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
  /// Begins one file after another, each on its own the next run of a few steps.
  std::jthread Begin(int files) {
    return std::jthread([this, files] {
      for (int i = 0; i < files; ++i) {
        queue_.PushBegin({StartIn(Mode::kFree)});
        ++begun_;
      }
    });
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
    for (int i = 0; i < 1000; ++i) std::this_thread::yield();  // one who does not wait would begin meanwhile
    EXPECT_LE(begun_, taken + 1) << "the one in hand: the recorder has not come back for more";
  }
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
