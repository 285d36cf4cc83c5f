// SPDX-License-Identifier: MIT
#include "server/control/record_modules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "tests/server/control/global_fixture.h"

namespace coopdyn {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

class PlaybackModuleTest : public GlobalModuleTest {
 protected:
  PlaybackModuleTest() {
    PlaybackStatus playback;
    playback.file = "/data/lesson1.run";
    playback.end = 60'000'000'000;
    playback.time = 12'500'000'000;
    playback.step = 1250;
    playback.speed = -2;
    playback.playing = true;
    run_.SetPlayback(playback);
    const auto make = [this](const std::string& file, std::uint64_t step, std::optional<double> time_s,
                             std::string& error) -> SavedStatePtr {
      asked_ = {file, step, time_s};
      error = make_error_;
      return make_error_.empty() ? State() : nullptr;
    };
    desk_.emplace(BranchDesk::Work{make, OpenOn({})}, edits_, run_, logger_);
    services_.apply_scene = [this](const auto& scene, const auto& done) {
      applied_scenes_.push_back(scene.get());
      done();
    };
    module_.emplace(services_, run_, *desk_, runs_, thread_.poster());
    client_.emplace(*module_, 1);
  }

  /// Lets the stepping thread continue with the state that was made, and waits for the reply.
  Message FinishBranch() {
    if (make_error_.empty()) {
      WaitForEdit();
      ApplyEdits();
    }
    thread_.RunUntil([&] { return !client_->is_waiting(); });
    return client_->received.back();
  }
  Message Branch(const std::string& line) {
    client_->Send(line);
    return FinishBranch();
  }

  struct Asked {
    std::string file;
    std::uint64_t step = 0;
    std::optional<double> time_s;
  };
  Asked asked_;
  std::string make_error_;
  std::vector<const Scene*> applied_scenes_;
  std::optional<BranchDesk> desk_;
  RunFolder runs_{testing::TempDir(), {}, [] { return std::string(); }, logger_};
  std::optional<PlaybackModule> module_;
  std::optional<FakeClient> client_;
};

TEST_F(PlaybackModuleTest, TellsWhatIsPlayed) {
  const Message reply = client_->Ask("get_playback");
  EXPECT_EQ(reply.text, "lesson1.run");
  EXPECT_THAT(reply.params, ElementsAre(1, 0, 0));
  EXPECT_THAT(reply.data, ElementsAre(0, DoubleEq(60), DoubleEq(12.5), -2, 0, 0));
}

TEST_F(PlaybackModuleTest, InALiveRunEverythingIsRefused) {
  run_.SetPlayback(std::nullopt);
  for (const char* line :
       {"get_playback", "seek 1", "play", "pause", "set_speed 2", "step", "set_loop on", "branch"}) {
    const Message reply = client_->Ask(line);
    EXPECT_EQ(reply.error, static_cast<std::int32_t>(Error::kNotPossible)) << line;
    EXPECT_THAT(reply.text, HasSubstr("coopdyn play RUN")) << line;
  }
  EXPECT_EQ(client_->Ask("ping").error, 0);
}

TEST_F(PlaybackModuleTest, CommandsReachWhoeverPlays) {
  EXPECT_EQ(Ask(*client_, "seek 12.5").error, 0);
  EXPECT_EQ(LastEdit<edit::Seek>().time, 12'500'000'000);
  Ask(*client_, "pause");
  EXPECT_NE(As<edit::Pause>(applied_.back()), nullptr);
  Ask(*client_, "set_speed -4");
  EXPECT_EQ(LastEdit<edit::SetPlaySpeed>().factor, -4);
  Ask(*client_, "step");
  EXPECT_EQ(LastEdit<edit::Skip>().steps, 1);
  Ask(*client_, "step -10");
  EXPECT_EQ(LastEdit<edit::Skip>().steps, -10);
  Ask(*client_, "set_loop on");
  EXPECT_TRUE(LastEdit<edit::SetLoop>().loop);
  Ask(*client_, "play");
  EXPECT_NE(As<edit::Run>(applied_.back()), nullptr);
}

TEST_F(PlaybackModuleTest, PlayTakesASpeedFirst) {
  Ask(*client_, "play 2");
  ASSERT_EQ(applied_.size(), 2u);
  EXPECT_EQ(As<edit::SetPlaySpeed>(applied_[0])->factor, 2);
  EXPECT_NE(As<edit::Run>(applied_[1]), nullptr);
}

TEST_F(PlaybackModuleTest, WhatCannotBeIsToldWithTheRange) {
  for (const char* line : {"set_speed 0", "set_speed 65", "set_speed -4.5", "play 0", "step 0"}) {
    EXPECT_EQ(client_->Ask(line).error, static_cast<std::int32_t>(Error::kOutOfRange)) << line;
  }
  EXPECT_THAT(client_->Ask("set_speed 65").text, HasSubstr("-4 to 64"));
  EXPECT_TRUE(applied_.empty());
}

TEST_F(PlaybackModuleTest, FarAwayTimesDoNotOverflow) {
  Ask(*client_, "seek 1e300");
  EXPECT_GT(LastEdit<edit::Seek>().time, 0);
  Ask(*client_, "seek -1e300");
  EXPECT_LT(LastEdit<edit::Seek>().time, 0);
}

TEST_F(PlaybackModuleTest, BranchGoesOnFromTheStepShown) {
  const Message reply = Branch("branch");
  EXPECT_EQ(reply.error, 0) << reply.text;
  EXPECT_EQ(asked_.file, "/data/lesson1.run");
  EXPECT_EQ(asked_.step, 1250u);
  EXPECT_FALSE(asked_.time_s);
  EXPECT_FALSE(LastEdit<edit::Restore>().state->paused);
  EXPECT_THAT(applied_scenes_, ElementsAre(world_.frames.Latest()->scene.get()));
}

TEST_F(PlaybackModuleTest, BranchTakesATimeAndStaysPausedIfTheRecordingStood) {
  PlaybackStatus standing = *run_.playback();
  standing.playing = false;
  run_.SetPlayback(standing);
  Branch("branch 7.25");
  EXPECT_EQ(asked_.time_s, 7.25);
  EXPECT_TRUE(LastEdit<edit::Restore>().state->paused);
}

TEST_F(PlaybackModuleTest, OneBranchAtATime) {
  client_->Send("branch");
  FakeClient other(*module_, 2);
  other.Send("branch");
  thread_.RunUntil([&] { return !other.is_waiting(); });
  const Message& refused = other.received.back();
  EXPECT_EQ(refused.error, static_cast<std::int32_t>(Error::kNotPossible));
  EXPECT_THAT(refused.text, HasSubstr("under way"));
  EXPECT_EQ(FinishBranch().error, 0);
  EXPECT_EQ(Branch("branch").error, 0);
}

TEST_F(PlaybackModuleTest, ABranchThatCannotBeSaysWhyAndLeavesThePlayback) {
  make_error_ = "another build made this recording";
  const Message reply = Branch("branch");
  EXPECT_EQ(reply.error, static_cast<std::int32_t>(Error::kNotPossible));
  EXPECT_EQ(reply.text, make_error_);
  EXPECT_TRUE(applied_.empty());
  EXPECT_TRUE(applied_scenes_.empty());
}

TEST_F(PlaybackModuleTest, StrangersWatchButDriveOnlyWithTheToken) {
  FakeClient stranger(*module_, 2, false);
  EXPECT_EQ(stranger.Ask("get_playback").error, 0);
  EXPECT_EQ(stranger.Ask("seek 1").error, static_cast<std::int32_t>(Error::kNotAllowed));
  stranger.Ask("hello ana secret");
  EXPECT_EQ(Ask(stranger, "seek 1").error, 0);
}

TEST_F(PlaybackModuleTest, ItCanBeSubscribedTo) {
  client_->Ask("subscribe");
  world_.Step();
  thread_.Run();
  ASSERT_EQ(client_->pushes().size(), 1u);
  EXPECT_EQ(client_->pushes()[0].command, -command::kGetPlayback);
}

}  // namespace
}  // namespace coopdyn
