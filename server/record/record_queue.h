// SPDX-License-Identifier: MIT
// The queue of items to record, from the holder of the baton to the recorder's thread. Bounded by its memory
// and by the steps that a crash may lose. Each side is one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "server/base/mutex.h"
#include "server/state/run_journal.h"

namespace coopdyn {

/// What a crash may lose. Unless the run is in real time, a step is not answered while more than this is
/// uncommitted.
struct CrashCost {
  std::size_t steps = 1000;       // 0: a step is answered once it is committed
  Nanoseconds age = 200'000'000;  // wall clock: since the oldest uncommitted step ran
};

struct QueuedStep {
  FramePtr frame;
  Mode mode = Mode::kRealtime;
  SavedStatePtr keyframe;  // null: the step is no keyframe
  Nanoseconds now = 0;     // wall clock: when it ran
};

struct QueuedBegin {
  SavedStatePtr state;
  int number = 1;              // file number
  int order = 1;               // among all begun files
  bool drops_present = false;  // remove the previous file because it is empty
};

struct QueuedItem {
  std::variant<QueuedBegin, QueuedStep, RunInput, Event> what;
  std::uint64_t lost_before = 0;  // steps left out just before it
  std::size_t bytes = 0;
};

class RecordQueue {
 public:
  explicit RecordQueue(std::size_t max_bytes, CrashCost most = {}) : max_bytes_(max_bytes), most_(most) {}

  // --- Called by the holder of the baton.
  /// Except in real time, waits until the previous file has begun: to end and begin a file takes longer than
  /// a short run, and a crash loses everything queued.
  void PushBegin(QueuedBegin begin) EXCLUDES(mutex_);
  /// Whether the next step must be a keyframe, with one every `every` steps.
  bool WantsKeyframe(std::uint64_t step, std::uint64_t every) EXCLUDES(mutex_);
  /// In real time, leaves the step out if there is no room. In the other modes, waits for room, then until a
  /// crash would lose no more than CrashCost.
  void PushStep(QueuedStep step) EXCLUDES(mutex_);
  /// If there is no room for an input, the next step becomes a keyframe that contains its effect.
  void PushInput(RunInput input) EXCLUDES(mutex_);
  void PushEvent(Event event) EXCLUDES(mutex_);

  // --- Called by the recorder's thread.
  /// The next item; nullopt after a short wait without one or, if `may_sleep`, once the queue has ended().
  std::optional<QueuedItem> Pop(bool may_sleep) EXCLUDES(mutex_);
  /// All items popped so far are committed.
  void NoteCommitted() EXCLUDES(mutex_);
  bool HasMore() const EXCLUDES(mutex_);
  /// Closed and empty.
  bool ended() const EXCLUDES(mutex_);
  /// Nothing can be written for now. Until Resume(), leaves out steps and inputs, including the queued ones,
  /// and makes no caller wait for room. `lost`: steps popped already that are left out too.
  void Stall(std::uint64_t lost) EXCLUDES(mutex_);
  void Resume() EXCLUDES(mutex_);
  /// Waits briefly. True if Close() was called.
  bool WaitStalled() EXCLUDES(mutex_);

  // --- Called by any thread.
  /// Accepts no more items; keeps the queued ones. Releases callers that wait for room.
  void Close() EXCLUDES(mutex_);
  /// Drops all queued and future items.
  void Fail() EXCLUDES(mutex_);
  /// Steps left out so far.
  std::uint64_t lost() const EXCLUDES(mutex_);
  /// Returns the number of steps left out after the last recorded one, and resets it to 0.
  std::uint64_t TakeLostAtEnd() EXCLUDES(mutex_);

 private:
  bool refuses() const REQUIRES(mutex_) { return closed_ || failed_; }
  bool waits() const REQUIRES(mutex_) { return !refuses() && !stalled_; }
  bool HasRoom(std::size_t bytes) const REQUIRES(mutex_) {
    return items_.empty() || bytes_ + bytes <= max_bytes_;
  }
  void Push(QueuedItem item) REQUIRES(mutex_);
  /// Pushes an input or event; false if there is no room.
  bool PushSmall(QueuedItem item) REQUIRES(mutex_);
  void WaitForRoom(std::size_t bytes) REQUIRES(mutex_);
  bool CostsTooMuch(Nanoseconds now) const REQUIRES(mutex_);
  void LeaveOut() REQUIRES(mutex_);
  void ForgetUncommitted() REQUIRES(mutex_);

  const std::size_t max_bytes_;
  const CrashCost most_;
  mutable Mutex mutex_;
  ConditionVariable work_, room_, committed_;
  std::deque<QueuedItem> items_ GUARDED_BY(mutex_);
  std::size_t bytes_ GUARDED_BY(mutex_) = 0;
  std::deque<Nanoseconds> uncommitted_ GUARDED_BY(mutex_);  // when each step ran, popped ones included
  std::size_t taken_ GUARDED_BY(mutex_) = 0;                // how many of uncommitted_ were popped
  int begins_ GUARDED_BY(mutex_) = 0;                       // among items_
  bool beginning_ GUARDED_BY(mutex_) = false;               // the recorder is making the file popped last
  bool closed_ GUARDED_BY(mutex_) = false, failed_ GUARDED_BY(mutex_) = false;
  bool stalled_ GUARDED_BY(mutex_) = false;
  bool sleeping_ GUARDED_BY(mutex_) = false;        // the recorder, until notified
  bool needs_keyframe_ GUARDED_BY(mutex_) = false;  // steps or inputs were left out
  std::uint64_t lost_ GUARDED_BY(mutex_) = 0, lost_since_ GUARDED_BY(mutex_) = 0;
  std::optional<std::uint64_t> keyframe_ GUARDED_BY(mutex_);  // step of the last; empty before the first file
};

}  // namespace coopdyn
