// SPDX-License-Identifier: MIT
// Which frame of a recording is shown at which time.
#include "server/record/player.h"

#include <fstream>
#include <iterator>

#include "tests/server/record/page_damage.h"
#include "tests/server/record/player_fixture.h"

namespace coopdyn {
namespace {

using PlayerCoreTest = PlayerFixture;

TEST_F(PlayerCoreTest, ShowsTheFirstFrameAtTheStart) {
  Record({});
  EXPECT_EQ(step(), 0u);
  EXPECT_EQ(frames_.Latest()->epoch, 1u);
  EXPECT_EQ(board_.mode(), Mode::kRealtime);
  EXPECT_EQ(control_.status().state, RunState::kPlaying);
  const auto playback = control_.playback();
  ASSERT_TRUE(playback);
  EXPECT_EQ(playback->file, file_);
  EXPECT_EQ(playback->end, 20 * SampleRun::kStep);
  EXPECT_EQ(playback->end_step, 20u);
  EXPECT_FALSE(playback->growing);
}

TEST_F(PlayerCoreTest, BeginsAtTheTimeAskedFor) {
  Record({}, {.start = 7 * SampleRun::kStep + 3});
  EXPECT_EQ(step(), 7u);
}

TEST_F(PlayerCoreTest, BackwardsItBeginsAtTheEnd) {
  Record({}, {.speed = -1});
  EXPECT_EQ(step(), 20u);
}

TEST_F(PlayerCoreTest, AtTheSpeedOfTheRunEveryStepIsShownAtItsTime) {
  Record({});
  const Nanoseconds began = now_;
  for (std::uint64_t k = 0; k <= 20; ++k) {
    const Nanoseconds due = began + static_cast<Nanoseconds>(k) * SampleRun::kStep;
    if (k > 0) {
      RunUntil(due - 1);
      EXPECT_EQ(step(), k - 1);
    }
    RunUntil(due);
    EXPECT_EQ(step(), k);
  }
}

TEST_F(PlayerCoreTest, ALateLookShowsTheNewestStepThatIsDue) {
  Record({});
  now_ += 75 * kMs;
  RunUntil(now_);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{0, 7}));
}

TEST_F(PlayerCoreTest, SlowMotionShowsEveryStep) {
  Record({}, {.speed = 0.25});
  RunUntil(now_ + 10 * 40 * kMs);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
}

TEST_F(PlayerCoreTest, FastItShowsSixtyFramesASecond) {
  Record({.steps = 2000, .keyframe_every = 500}, {.speed = 16});
  RunUntil(now_ + 1000 * kMs);
  EXPECT_NEAR(static_cast<double>(step()), 1600, 30);
  EXPECT_GE(shown_.size(), 55u);
  EXPECT_LE(shown_.size(), 62u);
}

TEST_F(PlayerCoreTest, LongStepsAreAllShownAtTwiceTheSpeed) {
  Record({.pose_every = 5 * SampleRun::kStep}, {.speed = 2});  // a frame each 25 ms
  RunUntil(now_ + 100 * kMs);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{0, 5, 10, 15, 20}));
}

TEST_F(PlayerCoreTest, TimeRunsBackwards) {
  Record({}, {.speed = -1});
  RunUntil(now_ + 200 * kMs);
  ASSERT_EQ(shown_.size(), 21u);
  for (std::size_t i = 0; i < shown_.size(); ++i) EXPECT_EQ(shown_[i]->step, 20 - i);
  EXPECT_EQ(last_event(), "info: the start of the recording");
}

TEST_F(PlayerCoreTest, TheEpochGrowsWithEachStepBack) {
  Record({}, {.speed = -1});
  RunUntil(now_ + 100 * kMs);
  for (std::size_t i = 1; i < shown_.size(); ++i) EXPECT_EQ(shown_[i]->epoch, shown_[i - 1]->epoch + 1);
}

TEST_F(PlayerCoreTest, TheEpochStaysWhileItPlaysForward) {
  Record({});
  RunUntil(now_ + 200 * kMs);
  for (const FramePtr& frame : shown_) EXPECT_EQ(frame->epoch, 1u);
}

TEST_F(PlayerCoreTest, AtTheEndItStandsAndSaysSoOnce) {
  Record({});
  RunUntil(now_ + 1000 * kMs);
  EXPECT_EQ(step(), 20u);
  EXPECT_EQ(control_.status().state, RunState::kPaused);
  EXPECT_FALSE(control_.playback()->playing);
  EXPECT_EQ(last_event(), "info: the recording has ended");
  EXPECT_EQ(control_.events().size(), 1u);
  EXPECT_EQ(wake_, kNever);
}

TEST_F(PlayerCoreTest, ALoopBeginsAgainAfterTheLastStep) {
  Record({.steps = 3}, {.loop = true});
  RunUntil(now_ + 65 * kMs);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{0, 1, 2, 3, 0, 1, 2}));
  EXPECT_EQ(shown_[3]->epoch, 1u);
  EXPECT_EQ(shown_[4]->epoch, 2u);
  EXPECT_TRUE(control_.events().empty());
}

TEST_F(PlayerCoreTest, ALoopBackwardsBeginsAgainAtTheEnd) {
  Record({.steps = 3}, {.speed = -1, .loop = true, .start = 2 * SampleRun::kStep});
  RunUntil(now_ + 25 * kMs);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{2, 1, 0, 3, 2}));
}

TEST_F(PlayerCoreTest, PausedItSleepsUntilTheBellRings) {
  Record({}, {.paused = true});
  RunUntil(now_ + 1000 * kMs);
  EXPECT_EQ(step(), 0u);
  EXPECT_EQ(wake_, kNever);
  EXPECT_EQ(control_.status().state, RunState::kPaused);
}

TEST_F(PlayerCoreTest, TheStatusIsPublishedAtLeastEveryFiftyMilliseconds) {
  Record({.steps = 3, .pose_every = 1'000'000'000}, {.speed = 0.01, .loop = true});
  RunUntil(now_ + 10 * kMs);
  EXPECT_LE(wake_, now_ + 50 * kMs);
}

TEST_F(PlayerCoreTest, LostStepsArePassedInTheirTime) {
  Record({.lost_from = 5, .lost_to = 9});
  RunUntil(now_ + 110 * kMs);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 10, 11}));
}

TEST_F(PlayerCoreTest, AGrowingFileIsFollowedAtItsEdge) {
  Record({.steps = 5, .close = false});
  RunUntil(now_ + 200 * kMs);
  EXPECT_EQ(step(), 5u);
  EXPECT_EQ(control_.status().state, RunState::kPlaying);
  EXPECT_TRUE(control_.events().empty());
  EXPECT_LE(wake_, now_ + 200 * kMs) << "looked at five times a second";
  EXPECT_TRUE(control_.playback()->growing);
  sample_.Append(*writer_, 6, 10);
  RunUntil(now_ + 300 * kMs);
  EXPECT_EQ(step(), 10u);
  EXPECT_EQ(control_.playback()->end_step, 10u);
  EXPECT_EQ(steps_shown(), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
}

TEST_F(PlayerCoreTest, AGrowingFileEndsWhenItIsClosed) {
  Record({.steps = 5, .close = false});
  RunUntil(now_ + 200 * kMs);
  std::string remark;
  ASSERT_TRUE(writer_->Close(remark));
  writer_.reset();
  RunUntil(now_ + 300 * kMs);
  EXPECT_EQ(control_.status().state, RunState::kPaused);
  EXPECT_EQ(last_event(), "info: the recording has ended");
  EXPECT_FALSE(control_.playback()->growing);
}

TEST_F(PlayerCoreTest, AGrowingFileIsSeenToGrowWhilePaused) {
  Record({.steps = 5, .close = false}, {.paused = true});
  RunUntil(now_ + 200 * kMs);
  EXPECT_EQ(control_.playback()->end_step, 5u);
  sample_.Append(*writer_, 6, 10);
  RunUntil(now_ + 200 * kMs);
  EXPECT_EQ(control_.playback()->end_step, 10u);
  EXPECT_TRUE(control_.playback()->growing);
  EXPECT_EQ(step(), 0u);
  std::string remark;
  ASSERT_TRUE(writer_->Close(remark));
  writer_.reset();
  RunUntil(now_ + 200 * kMs);
  EXPECT_FALSE(control_.playback()->growing);
  EXPECT_EQ(wake_, kNever);
}

/// Plays a file from start to end.
class OnePlay : public PlayerFixture {
 public:
  void TestBody() override {}
  /// The steps shown; empty if an error was reported.
  std::optional<std::vector<std::uint64_t>> Play(const std::string& file,
                                                 std::shared_ptr<const Scenario> scenario) {
    std::string error;
    auto reader = RunReader::Open(file, error);
    if (reader == nullptr) return std::nullopt;
    reader->UseScenario(std::move(scenario));
    core_ = std::make_unique<Player>(boards(), std::move(reader), clock_, NullLogger(), PlayOptions(), 0);
    if (!core_->Start(now_).empty()) return std::nullopt;
    RunUntil(now_ + 2000 * kMs);
    for (const Event& event : control_.events()) {
      if (event.level == "error") return std::nullopt;
    }
    return steps_shown();
  }
};

TEST_F(PlayerCoreTest, ADamagedPageIsSaidOrAllIsShown) {
  sample_.Write(file_, {.steps = 60, .page_size = 4096});
  std::ifstream stream(file_, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  const auto all = OnePlay().Play(file_, sample_.scenario());
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 61U);
  int damaged = 0;
  ForEachDamage(whole, file_, [&](const std::string& what) {
    const auto shown = OnePlay().Play(file_, sample_.scenario());
    if (!shown) {
      ++damaged;
    } else {
      EXPECT_EQ(*shown, *all) << what;
    }
  });
  EXPECT_GT(damaged, 30);
}

TEST_F(PlayerCoreTest, StepsThatAreMissingAreAnErrorNotAJump) {
  sample_.Write(file_);
  std::string error;
  Database::Open(file_, Database::Access::kReadWrite, error)->Run("DELETE FROM step WHERE step = 6");
  Start();
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ(step(), 5u);
  EXPECT_NE(last_event().find("is damaged (a gap from step 5 to 7)"), std::string::npos) << last_event();
}

TEST_F(PlayerCoreTest, ADamagedStepIsAnEventAndItStandsBeforeIt) {
  sample_.Write(file_);
  std::string error;
  Database::Open(file_, Database::Access::kReadWrite, error)
      ->Run("UPDATE step SET poses = x'00' WHERE step = 6");
  Start();
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ(step(), 5u);
  EXPECT_EQ(control_.status().state, RunState::kPaused);
  EXPECT_NE(last_event().find("error: " + file_ + " is damaged (the poses of step 6)"), std::string::npos)
      << last_event();
  EXPECT_EQ(Do(edit::Seek{8 * SampleRun::kStep})->error, Error::kOk);
  Do(edit::Run{});
  RunUntil(now_ + 500 * kMs);
  EXPECT_EQ(step(), 20u);
}

TEST_F(PlayerCoreTest, AFirstStepThatIsDamagedIsSaid) {
  sample_.Write(file_);
  std::string error;
  Database::Open(file_, Database::Access::kReadWrite, error)->Run("DELETE FROM keyframe");
  core_ = std::make_unique<Player>(boards(), OpenReader(), clock_, NullLogger(), PlayOptions{}, 0);
  EXPECT_NE(core_->Start(now_).find("keyframe"), std::string::npos);
}

}  // namespace
}  // namespace coopdyn
