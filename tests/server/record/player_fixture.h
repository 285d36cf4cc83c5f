// SPDX-License-Identifier: MIT
// A player of the sample recording, without threads: the test controls the time.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/record/player.h"
#include "tests/server/record/run_reader_sample.h"

namespace coopdyn {

class PlayerFixture : public testing::Test {
 protected:
  static constexpr Nanoseconds kNever = INT64_MAX;
  static constexpr Nanoseconds kMs = 1'000'000;

  PlayerFixture() {
    board_.AddObserver([this](const FramePtr& frame) { shown_.push_back(frame); });
  }

  std::unique_ptr<RunReader> OpenReader() {
    std::string error;
    auto reader = RunReader::Open(file_, error);
    EXPECT_NE(reader, nullptr) << error;
    if (reader != nullptr) reader->UseScenario(sample_.scenario());
    return reader;
  }
  Player::Boards boards() { return {frames_, board_, edits_, control_, bell_}; }

  /// Plays the file, and shows its first frame.
  void Start(PlayOptions options = {}) {
    core_ = std::make_unique<Player>(boards(), OpenReader(), clock_, NullLogger(), options, 0);
    ASSERT_EQ(core_->Start(now_), "");
  }
  void Record(const SampleRun::Options& options, PlayOptions play = {}) {
    writer_ = sample_.Write(file_, options);
    Start(play);
  }

  /// Advances the time to `wall`, and polls whenever the player asks for it.
  void RunUntil(Nanoseconds wall) {
    for (int looks = 0; looks < 100'000; ++looks) {
      Player::Work work = core_->WorkOnce(now_);
      wake_ = work.wake;
      if (work.ended_by) {
        ended_by_ = std::move(work.ended_by);
        return;
      }
      if (work.wake > wall) {
        now_ = wall;
        return;
      }
      now_ = std::max(now_, work.wake);
    }
    FAIL() << "it does not come to rest";
  }
  /// Applies an edit now; returns its reply, if any.
  std::optional<EditResult> Do(EditAction action) {
    std::optional<EditResult> answer;
    edits_.Push({std::move(action), [&answer](const EditResult& result) { answer = result; }});
    RunUntil(now_);
    return answer;
  }

  std::uint64_t step() const { return frames_.Latest()->step; }
  std::vector<std::uint64_t> steps_shown() const {
    std::vector<std::uint64_t> steps;
    for (const FramePtr& frame : shown_) steps.push_back(frame->step);
    return steps;
  }
  std::string last_event() const {
    const auto events = control_.events();
    return events.empty() ? "" : events.back().level + ": " + events.back().text;
  }

  const TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  const SampleRun sample_;
  std::unique_ptr<RunWriter> writer_;
  Doorbell bell_;
  FrameBoard frames_;
  CommandBoard board_;
  EditQueue edits_{bell_};
  RunControl control_;
  std::vector<FramePtr> shown_;
  SteadyClock clock_;  // for Player::Run() only
  std::unique_ptr<Player> core_;
  std::optional<Edit> ended_by_;
  Nanoseconds now_ = 1'000'000'000, wake_ = 0;
};

}  // namespace coopdyn
