// SPDX-License-Identifier: MIT
// Decides which frame is shown when. player_edits.cc applies edits.
#include "server/record/player.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace coopdyn {

namespace {

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();
constexpr Nanoseconds kStatusEvery = 50'000'000;
constexpr Nanoseconds kLookEvery = 100'000'000;
/// Above speed 1, at most one frame per screen refresh.
constexpr Nanoseconds kFrameEvery = kNanosecondsPerSecond / 60;

}  // namespace

Player::Player(Boards boards, std::shared_ptr<RunReader> reader, const Clock& clock, Logger logger,
               PlayOptions options, std::uint64_t epoch)
    : boards_(boards),
      reader_(std::move(reader)),
      clock_(clock),
      logger_(std::move(logger)),
      options_(options),
      frames_(*reader_),
      epoch_(epoch),
      speed_(options.speed),
      loop_(options.loop),
      playing_(!options.paused) {}

std::optional<Edit> Player::Run(std::stop_token stop) {
  Resume(clock_.Now());
  while (!stop.stop_requested()) {
    const std::uint64_t seen = boards_.bell.count();
    Work work = WorkOnce(clock_.Now());
    if (work.ended_by) return std::move(work.ended_by);
    if (work.wake > clock_.Now()) boards_.bell.WaitUntil(seen, work.wake);
  }
  Stop();
  return std::nullopt;
}

std::string Player::Start(Nanoseconds now) {
  now_ = now;
  Look(true);
  // Backwards, the default start is the end.
  const bool from_end = speed_ < 0 && options_.start == 0;
  const auto step = reader_->StepAt(from_end ? extent_.end : options_.start, true);
  if (!step || !Show(*step, Jump::kYes)) return reader_->error();
  if (extent_.missing > 0) {
    AddEvent("error", std::to_string(extent_.missing) + " steps are missing at its end: the file is damaged");
  }
  Resume(now);
  return {};
}

void Player::Resume(Nanoseconds now) {
  now_ = now;
  boards_.commands.SetPlaying(true);
  RestartPace(shown_->time);
  rate_.Reset();
  PublishStatus();
}

Player::Work Player::WorkOnce(Nanoseconds now) {
  now_ = now;
  Work work;
  work.ended_by = ApplyEdits();
  if (work.ended_by) {
    EndSteps(StepEnd::kLoad);
    boards_.commands.SetPlaying(false);
    boards_.control.SetPlayback(std::nullopt);
    return work;
  }
  work.wake = ShowDue();
  if (changed_ || (playing_ && now - status_at_ >= kStatusEvery)) PublishStatus();
  if (playing_) work.wake = std::min(work.wake, status_at_ + kStatusEvery);
  return work;
}

void Player::Stop() {
  boards_.edits.Close(boards_.control.stopping_text());
  EndSteps(StepEnd::kStopping);
  boards_.commands.Stop(shown_, boards_.control.stopping_text());
}

Nanoseconds Player::ShowDue() {
  if (!playing_ && steps_left() == 0) {
    Look(false);
    return reader_->growing() ? looked_at_ + kLookEvery : kNever;
  }
  return playing_ ? Resume() : GoByStep();
}

Nanoseconds Player::Resume() {
  const bool back = speed_ < 0;
  if (!back) Look(false);
  const std::optional<Place> next = Next(back);
  if (!next) return reader_->error().empty() ? AtEnd(back) : Fail();
  Nanoseconds wall = pace_.WallTime(back ? shown_->time : next->time);
  if (std::abs(speed_) > 1) wall = std::max(wall, shown_at_ + kFrameEvery);
  if (now_ < wall) return wall;
  const auto due = reader_->StepAt(pace_.DueTime(now_), true);
  if (!due) return Fail();
  const std::uint64_t step = back ? std::min(*due, next->step) : std::max(*due, next->step);
  return ShowOrStand(step, Jump::kNo) ? now_ : kNever;
}

Nanoseconds Player::GoByStep() {
  Look(false);
  const std::optional<Place> next = Next(false);
  if (!next && !reader_->error().empty()) return Fail();
  if (!next && reader_->growing()) {
    RestartPace(shown_->time);
    return now_ + kLookEvery;
  }
  if (!next) {
    AddEvent("info", "the recording has ended");
    EndSteps(StepEnd::kRan);
    return kNever;
  }
  const Nanoseconds wall = pace_.WallTime(next->time);
  if (now_ < wall) return wall;
  if (!ShowOrStand(next->step, Jump::kNo)) return kNever;
  // When late, do not speed up to catch up.
  if (pace_.DueTime(now_) > shown_->time + shown_->step_length) RestartPace(shown_->time);
  return now_;
}

Nanoseconds Player::AtEnd(bool back) {
  if (!back && reader_->growing()) {
    RestartPace(shown_->time);
    return now_ + kLookEvery;
  }
  // Show the last frame for the length of its step before wrapping around.
  const Nanoseconds end = !back && loop_ ? shown_->time + shown_->step_length : shown_->time;
  const Nanoseconds wall = pace_.WallTime(end) - (back ? 1 : 0);
  if (now_ < wall) return wall;
  if (!loop_) {
    AddEvent("info", back ? "the start of the recording" : "the recording has ended");
    Stand();
    return kNever;
  }
  Look(true);
  const auto step = reader_->StepAt(back ? extent_.end : extent_.begin, true);
  if (!step) return Fail();
  if (!ShowOrStand(*step, Jump::kYes)) return kNever;
  RestartPace(shown_->time);
  return now_;
}

bool Player::ShowOrStand(std::uint64_t step, Jump jump) {
  if (Show(step, jump)) return true;
  Fail();
  return false;
}

bool Player::Show(std::uint64_t step, Jump jump) {
  const std::shared_ptr<Frame> frame = frames_.Make(step);
  if (frame == nullptr) return false;
  const bool jumps = jump == Jump::kYes || (shown_ != nullptr && step <= shown_->step);
  if (jumps) ++epoch_;
  if (jump == Jump::kYes) rate_.Reset();
  frame->epoch = epoch_;
  const bool first = shown_ == nullptr;
  const bool new_scene = first || shown_->scene != frame->scene;
  shown_ = frame;
  next_.reset();
  shown_at_ = now_;
  changed_ = true;
  rate_.Note(now_, frame->time);
  boards_.commands.Latch(step);
  boards_.control.ReplaceLogged(logged_.At(step));
  boards_.frames.Publish(frame);
  if (new_scene) {
    boards_.commands.SetMode(Mode::kRealtime, now_);
    boards_.commands.Configure(*frame->scene, StepEnd::kLoad, frame, now_);
    boards_.commands.SetPlaying(true);
    if (!first && on_scene_) on_scene_(frame->scene);
  }
  boards_.commands.FinishStep(frame, now_);
  std::vector<PendingStep> ran;
  std::erase_if(steps_, [&ran](PendingStep& pending) {
    if (--pending.left > 0) return false;
    ran.push_back(std::move(pending));
    return true;
  });
  for (const PendingStep& pending : ran) {
    if (pending.done) pending.done({StepEnd::kRan, frame, Mode::kRealtime});
  }
  return true;
}

std::optional<Player::Place> Player::Next(bool back) {
  if (next_ && next_is_back_ == back) return next_;
  next_.reset();
  const std::optional<std::uint64_t> step = reader_->NextShown(shown_->step, back);
  if (!step) return std::nullopt;
  const std::optional<RecordedStep> read = reader_->Read(*step, true);
  if (!read) return std::nullopt;
  next_ = Place{*step, read->time};
  next_is_back_ = back;
  return next_;
}

void Player::Stand() {
  playing_ = false;
  changed_ = true;
  rate_.Reset();
}

Nanoseconds Player::Fail() {
  AddEvent("error", reader_->error());
  Stand();
  EndSteps(StepEnd::kReset);
  return kNever;
}

void Player::Look(bool always) {
  const bool due = reader_->growing() && now_ - looked_at_ >= kLookEvery;
  if (!always && !due) return;
  looked_at_ = now_;
  const Nanoseconds end = extent_.end;
  extent_ = reader_->extent();
  logged_.Add(reader_->EventsAfter(newest_event_));
  changed_ |= extent_.end != end || !reader_->growing();
}

void Player::RestartPace(Nanoseconds time) {
  pace_.Start(now_, time, pace_speed());
}

double Player::pace_speed() const {
  return playing_ ? speed_ : std::abs(speed_);  // steps go forward
}

void Player::EndSteps(StepEnd end) {
  const std::vector<PendingStep> ended = std::exchange(steps_, {});
  for (const PendingStep& pending : ended) {
    const std::int64_t ran = pending.asked - std::min(pending.asked, pending.left);
    if (pending.done) pending.done({end, shown_, Mode::kRealtime, ran, pending.asked});
  }
}

std::int64_t Player::steps_left() const {
  std::int64_t most = 0;
  for (const PendingStep& pending : steps_) most = std::max(most, pending.left);
  return most;
}

void Player::AddEvent(const char* level, std::string text) {
  const bool error = level == std::string_view("error");
  logger_->log(error ? spdlog::level::err : spdlog::level::info, "step {}: {}", shown_->step, text);
  boards_.control.AddEvent({shown_->step, shown_->time_s(), level, std::move(text)});
}

void Player::PublishStatus() {
  status_at_ = now_;
  changed_ = false;
  RunStatus status;
  status.mode = Mode::kRealtime;
  status.state = playing_ ? RunState::kPlaying : RunState::kPaused;
  status.step_length = shown_->step_length;
  status.speed = speed_;
  status.real_time_factor = playing_ ? rate_.Factor(now_, shown_->time) : 0;
  status.frozen = FrozenNames(*shown_);
  boards_.control.SetStatus(std::move(status));
  PlaybackStatus playback;
  playback.file = reader_->file();
  playback.begin = extent_.begin;
  playback.end = extent_.end;
  playback.begin_step = extent_.first;
  playback.end_step = extent_.last;
  playback.time = shown_->time;
  playback.step = shown_->step;
  playback.speed = speed_;
  playback.playing = playing_;
  playback.loop = loop_;
  playback.growing = reader_->growing();
  boards_.control.SetPlayback(std::move(playback));
}

}  // namespace coopdyn
