// SPDX-License-Identifier: MIT
#include "server/record/record_queue.h"

#include <chrono>
#include <utility>

namespace coopdyn {

namespace {

// How long the recorder sleeps while steps arrive: one wake-up for many steps costs the run less than one per
// step.
constexpr std::chrono::milliseconds kNap{5};
constexpr std::chrono::milliseconds kStalledNap{20};
// Inputs and events are small: they are left out only above this multiple of max_bytes.
constexpr std::size_t kMostForSmall = 2;

std::size_t BytesOf(const Frame& frame) {
  return sizeof(Frame) + frame.bodies.size() * sizeof(BodyState) +
         frame.channels.size() * sizeof(ChannelState) + frame.messages.size() * sizeof(SentMessage);
}

std::size_t ExtraBytes(const SavedState& state) {
  return state.controllers.size() + state.scores.size() * sizeof(double);
}

}  // namespace

void RecordQueue::Push(QueuedItem item) {
  bytes_ += item.bytes;
  items_.push_back(std::move(item));
  if (sleeping_ || bytes_ > max_bytes_ / 4) work_.NotifyOne();
}

bool RecordQueue::PushSmall(QueuedItem item) {
  if (bytes_ + item.bytes > kMostForSmall * max_bytes_) return false;
  Push(std::move(item));
  return true;
}

void RecordQueue::WaitForRoom(std::size_t bytes) {
  while (!HasRoom(bytes) && waits()) {
    work_.NotifyOne();
    room_.Wait(mutex_);
  }
}

bool RecordQueue::CostsTooMuch(Nanoseconds now) const {
  return uncommitted_.size() > most_.steps ||
         (!uncommitted_.empty() && now - uncommitted_.front() > most_.age);
}

void RecordQueue::PushBegin(QueuedBegin begin) {
  const SavedState& state = *begin.state;
  const std::size_t bytes = BytesOf(*state.frame) + ExtraBytes(state);
  const MutexLock lock(mutex_);
  if (state.mode != Mode::kRealtime) {
    while ((begins_ > 0 || beginning_) && waits()) {
      work_.NotifyOne();
      room_.Wait(mutex_);
    }
    WaitForRoom(bytes);
  }
  if (refuses()) return;
  std::uint64_t lost = std::exchange(lost_since_, 0);
  if (stalled_ && begins_ > 0) {
    // Drop a queued file that could not be started: steps lost before it belong to the open file.
    for (const QueuedItem& item : items_) {
      if (!std::holds_alternative<QueuedBegin>(item.what)) continue;
      lost = item.lost_before;
      break;
    }
    items_.clear();
    bytes_ = 0;
    begins_ = 0;
  }
  ++begins_;
  keyframe_ = state.frame->step;
  needs_keyframe_ = false;
  Push({std::move(begin), lost, bytes});
}

bool RecordQueue::WantsKeyframe(std::uint64_t step, std::uint64_t every) {
  const MutexLock lock(mutex_);
  if (refuses() || stalled_ || !keyframe_) return false;
  // Only with room for some steps: making a keyframe takes time, and the next step would be lost.
  if (needs_keyframe_) return HasRoom(max_bytes_ / 2);
  return step - *keyframe_ >= every;
}

void RecordQueue::PushStep(QueuedStep step) {
  const std::size_t bytes =
      BytesOf(*step.frame) + (step.keyframe == nullptr ? 0 : ExtraBytes(*step.keyframe));
  const MutexLock lock(mutex_);
  const bool is_wanted = step.keyframe != nullptr || !needs_keyframe_;
  if (step.mode != Mode::kRealtime) WaitForRoom(is_wanted ? bytes : max_bytes_ / 2);
  if (refuses() || !keyframe_) return;
  if (stalled_ || !is_wanted || !HasRoom(bytes)) return LeaveOut();
  if (step.keyframe != nullptr) {
    keyframe_ = step.frame->step;
    needs_keyframe_ = false;
  }
  const bool may_wait = step.mode != Mode::kRealtime;
  const Nanoseconds now = step.now;
  uncommitted_.push_back(now);
  Push({std::move(step), std::exchange(lost_since_, 0), bytes});
  while (may_wait && waits() && CostsTooMuch(now)) {
    work_.NotifyOne();
    committed_.Wait(mutex_);
  }
}

void RecordQueue::ForgetUncommitted() {
  uncommitted_.clear();
  taken_ = 0;
  committed_.NotifyAll();
}

void RecordQueue::LeaveOut() {
  ++lost_;
  ++lost_since_;
  needs_keyframe_ = true;
}

void RecordQueue::PushInput(RunInput input) {
  const std::size_t bytes = sizeof(QueuedItem) + Encode(input).detail.size();
  const MutexLock lock(mutex_);
  if (refuses() || !keyframe_) return;
  if (stalled_ || !PushSmall({std::move(input), 0, bytes})) needs_keyframe_ = true;
}

void RecordQueue::PushEvent(Event event) {
  const std::size_t bytes = sizeof(QueuedItem) + event.level.size() + event.text.size();
  const MutexLock lock(mutex_);
  if (!refuses() && keyframe_) PushSmall({std::move(event), 0, bytes});
}

std::optional<QueuedItem> RecordQueue::Pop(bool may_sleep) {
  const MutexLock lock(mutex_);
  if (std::exchange(beginning_, false)) room_.NotifyAll();
  if (items_.empty() && !closed_) work_.WaitUntil(mutex_, std::chrono::steady_clock::now() + kNap);
  while (may_sleep && items_.empty() && !closed_) {
    sleeping_ = true;
    work_.Wait(mutex_);
    sleeping_ = false;
  }
  if (items_.empty()) return std::nullopt;
  QueuedItem item = std::move(items_.front());
  items_.pop_front();
  bytes_ -= item.bytes;
  beginning_ = std::holds_alternative<QueuedBegin>(item.what);
  if (beginning_) --begins_;
  if (std::holds_alternative<QueuedStep>(item.what)) ++taken_;
  // Wake the waiting thread when there is room for many steps, not for one.
  if (bytes_ <= max_bytes_ / 2) room_.NotifyAll();
  return item;
}

void RecordQueue::NoteCommitted() {
  const MutexLock lock(mutex_);
  uncommitted_.erase(uncommitted_.begin(), uncommitted_.begin() + static_cast<std::ptrdiff_t>(taken_));
  taken_ = 0;
  committed_.NotifyAll();
}

bool RecordQueue::HasMore() const {
  const MutexLock lock(mutex_);
  return !items_.empty();
}

bool RecordQueue::ended() const {
  const MutexLock lock(mutex_);
  return closed_ && items_.empty();
}

void RecordQueue::Stall(std::uint64_t lost) {
  std::deque<QueuedItem> waiting;  // freed without the lock
  const MutexLock lock(mutex_);
  stalled_ = needs_keyframe_ = true;
  lost_ += lost;
  waiting.swap(items_);
  bytes_ = 0;
  std::uint64_t since = 0;
  for (QueuedItem& item : waiting) {
    since += std::exchange(item.lost_before, 0);
    const bool is_step = std::holds_alternative<QueuedStep>(item.what);
    if (is_step) ++since, ++lost_;
    if (is_step || std::holds_alternative<RunInput>(item.what)) continue;
    if (std::holds_alternative<QueuedBegin>(item.what)) item.lost_before = std::exchange(since, 0);
    bytes_ += item.bytes;
    items_.push_back(std::move(item));
  }
  lost_since_ += since;
  ForgetUncommitted();
  room_.NotifyAll();
}

void RecordQueue::Resume() {
  const MutexLock lock(mutex_);
  stalled_ = false;
}

bool RecordQueue::WaitStalled() {
  const MutexLock lock(mutex_);
  if (!closed_) work_.WaitUntil(mutex_, std::chrono::steady_clock::now() + kStalledNap);
  return closed_;
}

void RecordQueue::Close() {
  const MutexLock lock(mutex_);
  closed_ = true;
  work_.NotifyAll();
  room_.NotifyAll();
  committed_.NotifyAll();
}

void RecordQueue::Fail() {
  std::deque<QueuedItem> dropped;  // freed without the lock
  const MutexLock lock(mutex_);
  failed_ = true;
  dropped.swap(items_);
  bytes_ = 0;
  begins_ = 0;
  ForgetUncommitted();
  room_.NotifyAll();
}

std::uint64_t RecordQueue::lost() const {
  const MutexLock lock(mutex_);
  return lost_;
}

std::uint64_t RecordQueue::TakeLostAtEnd() {
  const MutexLock lock(mutex_);
  return std::exchange(lost_since_, 0);
}

}  // namespace coopdyn
