// SPDX-License-Identifier: MIT
// The player on its own thread, with the machine's clock.
#include "server/record/player.h"

#include <future>
#include <thread>

#include "tests/server/record/player_fixture.h"

namespace coopdyn {
namespace {

class PlayerTest : public PlayerFixture {
 protected:
  void StartThread(const SampleRun::Options& options, PlayOptions play) {
    writer_ = sample_.Write(file_, options);
    player_ = std::make_unique<Player>(boards(), OpenReader(), clock_, NullLogger(), play, 4);
    ASSERT_EQ(player_->Start(), "");
    thread_ = std::jthread([this](const std::stop_token& stop) { ended_by_ = player_->Run(stop); });
  }
  void TearDown() override {
    thread_.request_stop();
    bell_.Ring();
    if (thread_.joinable()) thread_.join();
  }
  std::future<StepResult> Wait(int steps) {
    auto promise = std::make_shared<std::promise<StepResult>>();
    board_.WaitSteps(steps, [promise](const StepResult& result) { promise->set_value(result); });
    return promise->get_future();
  }
  EditResult Ask(EditAction action) {
    std::promise<EditResult> promise;
    edits_.Push({std::move(action), [&promise](const EditResult& result) { promise.set_value(result); }});
    return promise.get_future().get();
  }

  std::unique_ptr<Player> player_;
  std::jthread thread_;
};

TEST_F(PlayerTest, PlaysByItself) {
  StartThread({.steps = 500, .keyframe_every = 100}, {.loop = true});
  EXPECT_EQ(Wait(5).get().end, StepEnd::kRan);
}

TEST_F(PlayerTest, AnEditWakesItWhileItStands) {
  StartThread({}, {.paused = true});
  EXPECT_EQ(Ask(edit::Seek{10 * SampleRun::kStep}).frame->step, 10u);
  EXPECT_EQ(Ask(edit::Skip{-1}).frame->step, 9u);
}

TEST_F(PlayerTest, FollowsAFileThatIsBeingWritten) {
  StartThread({.steps = 2, .close = false}, {.speed = 64});
  for (std::uint64_t step = 3; step <= 12; ++step) {
    auto shown = Wait(1);
    sample_.Append(*writer_, step, step);
    const StepResult result = shown.get();
    EXPECT_LE(result.frame->step, step);
  }
}

TEST_F(PlayerTest, StopEndsAllWaits) {
  StartThread({}, {.paused = true});
  auto waits = Wait(1);
  thread_.request_stop();
  bell_.Ring();
  EXPECT_EQ(waits.get().end, StepEnd::kStopping);
  thread_.join();
  EXPECT_FALSE(ended_by_);
  EXPECT_EQ(Ask(edit::Run{}).error, Error::kNotPossible);
}

TEST_F(PlayerTest, RestoreIsHandedOverAndItCanGoOnIfItWasRefused) {
  StartThread({}, {.paused = true});
  edits_.Push({edit::Restore{std::make_shared<SavedState>(sample_.StateAt(4))}, nullptr});
  bell_.Ring();
  thread_.join();
  ASSERT_TRUE(ended_by_);
  EXPECT_FALSE(control_.playback());
  EXPECT_GE(player_->epoch(), 5u);
  thread_ = std::jthread([this](const std::stop_token& stop) { ended_by_ = player_->Run(stop); });
  EXPECT_EQ(Ask(edit::Seek{10 * SampleRun::kStep}).frame->step, 10u);
  EXPECT_TRUE(control_.playback());
}

}  // namespace
}  // namespace coopdyn
