// SPDX-License-Identifier: MIT
#include "server/devices/step_inbox.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "server/base/wrong_tokens.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

class StepInboxTest : public testing::Test, protected StepListener {
 protected:
  void OnStepEnd(ClientId client, const StepResult& result) override {
    log_.push_back("reply " + std::to_string(client) + " of " + std::to_string(result.frame->step));
  }
  bool OnFrame(const FramePtr& frame, int dropped) override {
    log_.push_back("frame " + std::to_string(frame->step));
    dropped_ += dropped;
    return takes_;
  }
  void RunPosted() {
    for (const auto& work : std::exchange(posted_, {})) work();
  }

  SmallWorld world_{1, Mode::kRealtime};
  std::vector<std::function<void()>> posted_;
  std::vector<std::string> log_;
  int dropped_ = 0;
  bool takes_ = true;
  std::optional<StepInbox> inbox_{std::in_place, world_.board, world_.frames,
                                  [this](std::function<void()> work) { posted_.push_back(std::move(work)); }};
};

TEST_F(StepInboxTest, NobodyIsWokenWithoutSubscription) {
  world_.Step();
  EXPECT_TRUE(posted_.empty());
}

TEST_F(StepInboxTest, FrameComesBeforeTheAnswerOfItsStepInOneBatch) {
  inbox_->Subscribe(*this);
  world_.board.WaitSteps(1, inbox_->Waiter(*this, 7));
  world_.Step();
  world_.Step();
  EXPECT_EQ(posted_.size(), 1u);
  RunPosted();
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "reply 7 of 1", "frame 2"}));
}

TEST_F(StepInboxTest, InAScopeItIsHandledAtTheEndWithoutWakeUp) {
  {
    const StepInbox::Scope outer(*inbox_);
    {
      const StepInbox::Scope inner(*inbox_);
      world_.board.WaitSteps(1, inbox_->Waiter(*this, 7));
      world_.Step();
    }
    EXPECT_TRUE(log_.empty());
  }
  EXPECT_EQ(log_, (std::vector<std::string>{"reply 7 of 1"}));
  EXPECT_TRUE(posted_.empty());
}

TEST_F(StepInboxTest, TheResultOfTheRequestInHandIsTakenAtOnceAfterTheFramesBefore) {
  inbox_->Subscribe(*this);
  {
    const StepInbox::Scope scope(*inbox_, 7);
    for (const ClientId client : {7, 8}) world_.board.WaitSteps(1, inbox_->Waiter(*this, client));
    EXPECT_FALSE(inbox_->TakeOwn());
    world_.Step();
    const std::optional<StepResult> own = inbox_->TakeOwn();
    ASSERT_TRUE(own);
    EXPECT_EQ(own->frame->step, 1u);
    EXPECT_EQ(log_, (std::vector<std::string>{"frame 1"}));
    EXPECT_FALSE(inbox_->TakeOwn());
  }
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "reply 8 of 1"}));
  EXPECT_TRUE(posted_.empty());
}

TEST_F(StepInboxTest, OnlyALockstepStepHandsItsAnswersOver) {
  for (const Mode mode : {Mode::kRealtime, Mode::kLockstep}) {
    SmallWorld world(1, mode);
    int posts = 0, handed = 0;
    StepInbox inbox(
        world.board, world.frames, [&posts](const std::function<void()>&) { ++posts; },
        [&handed](const std::function<void()>& work) {
          ++handed;
          work();
        });
    world.board.WaitSteps(1, inbox.Waiter(*this, 7));
    world.Step();
    EXPECT_EQ(handed, mode == Mode::kLockstep ? 1 : 0);
    EXPECT_EQ(posts, mode == Mode::kLockstep ? 0 : 1);
    EXPECT_EQ(log_.size(), mode == Mode::kLockstep ? 1u : 0u);
  }
}

TEST_F(StepInboxTest, CurrentFrameIsPushedBeforeItIsReported) {
  inbox_->Subscribe(*this);
  world_.Step();
  world_.Publish();  // step 2 is visible, its observers are not called yet
  {
    const StepInbox::Scope scope(*inbox_);
    EXPECT_EQ(inbox_->Current()->step, 2u);
    EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "frame 2"}));
  }
  world_.Finish();
  RunPosted();
  EXPECT_EQ(log_.size(), 2u) << "no frame comes twice";
}

TEST_F(StepInboxTest, StepKnownAtSubscriptionIsNotPushed) {
  world_.Publish();
  inbox_->Subscribe(*this);
  world_.Finish();
  world_.Step();
  RunPosted();
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 2"}));
}

TEST_F(StepInboxTest, FramesGoOnAfterALoad) {
  inbox_->Subscribe(*this);
  world_.Step();
  world_.Step();
  world_.Load(SmallScenario(1), Mode::kRealtime);
  world_.Step();
  RunPosted();
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "frame 2", "frame 1"}));
}

TEST_F(StepInboxTest, BeyondSixtyFourTheOldestFramesAreDroppedAndCountedButNoAnswer) {
  inbox_->Subscribe(*this);
  world_.board.WaitSteps(1, inbox_->Waiter(*this, 7));
  for (int i = 0; i < 70; ++i) world_.Step();
  RunPosted();
  EXPECT_EQ(log_.size(), 65u);
  EXPECT_EQ(log_[0], "reply 7 of 1");
  EXPECT_EQ(log_[1], "frame 7");
  EXPECT_EQ(log_.back(), "frame 70");
  EXPECT_EQ(dropped_, 6);
}

TEST_F(StepInboxTest, WhoTakesNothingIsNotWokenAndGetsTheNewestFramesLater) {
  takes_ = false;
  inbox_->Subscribe(*this);
  world_.Step();
  RunPosted();
  for (std::size_t i = 0; i < StepInbox::kMaxFrames + 6; ++i) world_.Step();
  EXPECT_TRUE(posted_.empty());
  { const StepInbox::Scope scope(*inbox_); }
  EXPECT_EQ(log_.size(), 1u);
  inbox_->TakesMore();
  EXPECT_EQ(log_.size(), 1 + StepInbox::kMaxFrames);
  EXPECT_EQ(log_[1], "frame 8");
  EXPECT_EQ(log_.back(), "frame 71");
  EXPECT_EQ(dropped_, 6);
}

TEST_F(StepInboxTest, WhoTakesSomethingAgainIsWokenForEachFrame) {
  takes_ = false;
  inbox_->Subscribe(*this);
  world_.Step();
  RunPosted();
  world_.Step();
  takes_ = true;
  inbox_->TakesMore();
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "frame 2"}));
  world_.Step();
  EXPECT_EQ(posted_.size(), 1u);
}

TEST_F(StepInboxTest, WhoTakesSomethingAgainIsWokenAlsoIfNoFrameWaited) {
  takes_ = false;
  inbox_->Subscribe(*this);
  world_.Step();
  RunPosted();
  takes_ = true;
  inbox_->TakesMore();
  world_.Step();
  EXPECT_EQ(posted_.size(), 1u);
}

TEST_F(StepInboxTest, AnAnswerWakesAlsoWhereFramesDoNot) {
  takes_ = false;
  inbox_->Subscribe(*this);
  world_.Step();
  RunPosted();
  world_.board.WaitSteps(1, inbox_->Waiter(*this, 7));
  world_.Step();
  EXPECT_EQ(posted_.size(), 1u);
  RunPosted();
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "frame 2", "reply 7 of 2"}));
}

TEST_F(StepInboxTest, AfterItsEndNothingComes) {
  inbox_->Subscribe(*this);
  world_.board.WaitSteps(2, inbox_->Waiter(*this, 7));
  auto poster = inbox_->MakePoster();
  world_.Step();
  inbox_.reset();
  world_.Step();
  poster([this] { log_.push_back("work"); });
  RunPosted();
  EXPECT_TRUE(log_.empty());
}

TEST_F(StepInboxTest, PostedWorkKeepsItsPlaceAmongFrames) {
  inbox_->Subscribe(*this);
  auto poster = inbox_->MakePoster();
  world_.Step();
  poster([this] { log_.push_back("work"); });
  world_.Step();
  RunPosted();
  EXPECT_EQ(log_, (std::vector<std::string>{"frame 1", "work", "frame 2"}));
}

TEST(TokenGuardTest, OnlyTheWholeTokenMatches) {
  const TokenGuard guard("secret", true);
  EXPECT_TRUE(guard.Matches("secret"));
  for (const char* wrong : {"", "secre", "secrets", "Secret", "secretsecret"})
    EXPECT_FALSE(guard.Matches(wrong));
  EXPECT_FALSE(TokenGuard("", true).Matches(""));
}

}  // namespace
}  // namespace coopdyn
