// SPDX-License-Identifier: MIT
// Applies edits to a playback.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <variant>

#include "server/record/player.h"

namespace coopdyn {

std::optional<Edit> Player::ApplyEdits() {
  while (std::optional<Edit> edit = boards_.edits.TakeNext()) {
    // Later edits are for the next run and stay in the queue.
    const bool ends = As<edit::Restore>(edit->action) != nullptr || As<edit::Play>(edit->action) != nullptr;
    if (ends) return edit;
    EditResult result = ApplyAny(*edit);
    result.frame = shown_;
    PublishStatus();
    const bool waits = As<edit::Step>(edit->action) != nullptr && result.error == Error::kOk;
    if (edit->done && !waits) edit->done(result);
  }
  return std::nullopt;
}

EditResult Player::ApplyAny(Edit& edit) {
  const EditAction& action = edit.action;
  if (const auto* moves = std::get_if<PlaybackEdit>(&action)) {
    return std::visit([this](const auto& move) { return Apply(move); }, *moves);
  }
  if (const auto* run = As<edit::Run>(action)) return Apply(*run);
  if (const auto* pause = As<edit::Pause>(action)) return Apply(*pause);
  if (const auto* step = As<edit::Step>(action)) return Apply(*step, std::move(edit.stepped));
  if (const auto* reset = As<edit::Reset>(action)) return Apply(*reset);
  if (const auto* set = As<edit::SetJournal>(action); set != nullptr && set->journal == nullptr) return {};
  return {Error::kNotPossible, kPlayingText};
}

EditResult Player::Apply(const edit::Run&) {
  if (playing_) return {};
  Look(true);
  const bool back = speed_ < 0;
  const bool at_end = !Next(back) && reader_->error().empty() && (back || !reader_->growing());
  if (at_end) {
    EditResult jumped = JumpTo(reader_->StepAt(back ? extent_.end : extent_.begin, true));
    if (jumped.error != Error::kOk) return jumped;
  }
  playing_ = true;
  rate_.Reset();
  RestartPace(shown_->time);
  return {};
}

EditResult Player::Apply(const edit::Pause&) {
  Stand();
  EndSteps(StepEnd::kPaused);
  RestartPace(shown_->time);
  return {};
}

EditResult Player::Apply(const edit::Step& step, StepDone done) {
  if (playing_) return {Error::kNotPossible, "step works only while paused: send pause first"};
  if (steps_.empty()) RestartPace(shown_->time);
  // As in a live run: queue behind earlier requests.
  const std::int64_t asked = std::max(step.steps, 1);
  steps_.push_back({steps_left() + asked, asked, std::move(done)});
  return {};
}

EditResult Player::Apply(const edit::Reset& reset) {
  if (reset.seed && *reset.seed != shown_->seed) {
    return {Error::kNotPossible, "a recording has the seed that it was made with: reset without one"};
  }
  Look(true);
  return JumpTo(reader_->StepAt(extent_.begin, true));
}

EditResult Player::Apply(const edit::Seek& seek) {
  Look(true);
  return JumpTo(reader_->StepAt(seek.time, true));
}

EditResult Player::Apply(const edit::Skip& skip) {
  Look(true);
  const std::optional<std::uint64_t> step = StepAway(skip.steps);
  if (step) Stand();
  return JumpTo(step);
}

EditResult Player::Apply(const edit::SetPlaySpeed& set) {
  if (!IsPlaySpeed(set.factor)) return {Error::kOutOfRange, std::string("this speed") + kNoPlaySpeed};
  const Nanoseconds due = std::clamp(pace_.DueTime(now_), extent_.begin, extent_.end);
  speed_ = set.factor;
  next_.reset();
  RestartPace(playing_ ? due : shown_->time);
  rate_.Reset();
  return {};
}

EditResult Player::Apply(const edit::SetLoop& set) {
  loop_ = set.loop;
  return {};
}

EditResult Player::JumpTo(std::optional<std::uint64_t> step) {
  if (!step || !Show(*step, Jump::kYes)) return {Error::kInternal, reader_->error()};
  EndSteps(StepEnd::kReset);
  RestartPace(shown_->time);
  return {};
}

std::optional<std::uint64_t> Player::StepAway(int steps) {
  std::uint64_t step = shown_->step;
  const bool back = steps < 0;
  const auto wanted = static_cast<std::uint64_t>(std::abs(std::int64_t{steps}));
  const bool all_shown = extent_.lost == 0 && reader_->header().pose_every == 0;
  if (all_shown && back) return std::max(extent_.first, step - std::min(step, wanted));
  if (all_shown) return std::min(extent_.last, step + wanted);
  for (std::uint64_t i = 0; i < wanted; ++i) {
    const std::optional<std::uint64_t> next = reader_->NextShown(step, back);
    if (!next && !reader_->error().empty()) return std::nullopt;
    if (!next) break;
    step = *next;
  }
  return step;
}

}  // namespace coopdyn
