// SPDX-License-Identifier: MIT
#include "server/record/record_queue.h"

#include <chrono>
#include <utility>

namespace coopdyn {

namespace {

// So long the recorder looks away while steps come: one wake-up for many of them costs the run less than one
// for each.
constexpr std::chrono::milliseconds kNap{5};
// Inputs and events are small and never left out, unless there are so many.
constexpr std::size_t kMostForSmall = 2;

std::size_t BytesOf(const Frame& frame) {
  return sizeof(Frame) + frame.bodies.size() * sizeof(BodyState) + frame.robots.size() * sizeof(RobotState) +
         frame.messages.size() * sizeof(SentMessage);
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
  while (!HasRoom(bytes) && !refuses()) {
    work_.NotifyOne();
    room_.Wait(mutex_);
  }
}

void RecordQueue::PushBegin(QueuedBegin begin) {
  const SavedState& state = *begin.state;
  const std::size_t bytes = BytesOf(*state.frame) + state.controllers.size();
  const MutexLock lock(mutex_);
  if (state.mode != Mode::kRealtime) {
    while (begins_ > 0 && !refuses()) {
      work_.NotifyOne();
      room_.Wait(mutex_);
    }
    WaitForRoom(bytes);
  }
  if (refuses()) return;
  ++begins_;
  keyframe_ = state.frame->step;
  needs_keyframe_ = false;
  Push({std::move(begin), std::exchange(lost_since_, 0), bytes});
}

bool RecordQueue::WantsKeyframe(std::uint64_t step, std::uint64_t every) {
  const MutexLock lock(mutex_);
  if (refuses() || !keyframe_) return false;
  // Not before there is room again for a while: to make one costs time, and the next step would be lost.
  if (needs_keyframe_) return HasRoom(max_bytes_ / 2);
  return step - *keyframe_ >= every;
}

void RecordQueue::PushStep(QueuedStep step) {
  const std::size_t bytes = BytesOf(*step.frame) + step.controllers.size();
  const MutexLock lock(mutex_);
  const bool is_wanted = step.keyframe || !needs_keyframe_;
  if (step.mode != Mode::kRealtime) WaitForRoom(is_wanted ? bytes : max_bytes_ / 2);
  if (refuses() || !keyframe_) return;
  if (!is_wanted || !HasRoom(bytes)) {
    ++lost_;
    ++lost_since_;
    needs_keyframe_ = true;
    return;
  }
  if (step.keyframe) {
    keyframe_ = step.frame->step;
    needs_keyframe_ = false;
  }
  Push({std::move(step), std::exchange(lost_since_, 0), bytes});
}

void RecordQueue::PushInput(RunInput input) {
  const std::size_t bytes = sizeof(QueuedItem) + input.action.size() + input.detail.size();
  const MutexLock lock(mutex_);
  if (refuses() || !keyframe_) return;
  if (!PushSmall({std::move(input), 0, bytes})) needs_keyframe_ = true;
}

void RecordQueue::PushEvent(Event event) {
  const std::size_t bytes = sizeof(QueuedItem) + event.level.size() + event.text.size();
  const MutexLock lock(mutex_);
  if (!refuses() && keyframe_) PushSmall({std::move(event), 0, bytes});
}

std::optional<QueuedItem> RecordQueue::Pop(bool may_sleep) {
  const MutexLock lock(mutex_);
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
  const bool begins = std::holds_alternative<QueuedBegin>(item.what);
  if (begins) --begins_;
  // Whoever waits for room gets some for a while, not for one step.
  if (begins || bytes_ <= max_bytes_ / 2) room_.NotifyAll();
  return item;
}

bool RecordQueue::ended() const {
  const MutexLock lock(mutex_);
  return closed_ && items_.empty();
}

void RecordQueue::Close() {
  const MutexLock lock(mutex_);
  closed_ = true;
  work_.NotifyAll();
  room_.NotifyAll();
}

void RecordQueue::Fail() {
  std::deque<QueuedItem> dropped;  // freed without the lock
  const MutexLock lock(mutex_);
  failed_ = true;
  dropped.swap(items_);
  bytes_ = 0;
  begins_ = 0;
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
