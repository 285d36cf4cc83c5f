// SPDX-License-Identifier: MIT
// What waits to be recorded: from the holder of the step baton to the recorder's thread. Bounded by the
// memory that it holds, and by what a crash may cost. Each side is one thread at a time.
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

/// What a crash may cost: no step of a run that can wait is answered while more than this is not committed.
struct CrashCost {
  std::size_t steps = 1000;       // 0: a step is answered when it is committed
  Nanoseconds age = 200'000'000;  // wall clock: since the oldest of them
};

struct QueuedStep {
  FramePtr frame;
  Mode mode = Mode::kRealtime;
  SavedStatePtr keyframe;  // null: none
  Nanoseconds now = 0;     // wall clock: when it ran
};

struct QueuedBegin {
  SavedStatePtr state;
  int number = 1;              // of the file
  int order = 1;               // of all that were begun
  bool drops_present = false;  // the file before, as nothing stands in it
};

struct QueuedItem {
  std::variant<QueuedBegin, QueuedStep, RunInput, Event> what;
  std::uint64_t lost_before = 0;  // steps that were left out just before it
  std::size_t bytes = 0;
};

class RecordQueue {
 public:
  explicit RecordQueue(std::size_t max_bytes, CrashCost most = {}) : max_bytes_(max_bytes), most_(most) {}

  // --- the holder of the baton
  /// Except in real time, it waits until the file before has begun. Ending and beginning a file takes longer
  /// than a short run, and a crash loses all that waits.
  void PushBegin(QueuedBegin begin) EXCLUDES(mutex_);
  /// Whether the next step is to be a keyframe, if there is one every `every` steps.
  bool WantsKeyframe(std::uint64_t step, std::uint64_t every) EXCLUDES(mutex_);
  /// In real time a step that finds no room is left out. In the other modes it waits for some, and returns
  /// when a crash costs no more than it may.
  void PushStep(QueuedStep step) EXCLUDES(mutex_);
  /// An input that finds no room at all makes the next step a keyframe, so that it is not missed.
  void PushInput(RunInput input) EXCLUDES(mutex_);
  void PushEvent(Event event) EXCLUDES(mutex_);

  // --- the recorder's thread
  /// The next item. Nothing: there was none for a short while, or, if `may_sleep`, the queue was ended().
  std::optional<QueuedItem> Pop(bool may_sleep) EXCLUDES(mutex_);
  /// What was taken so far is committed.
  void NoteCommitted() EXCLUDES(mutex_);
  bool HasMore() const EXCLUDES(mutex_);
  /// Closed, and all was taken.
  bool ended() const EXCLUDES(mutex_);
  /// Nothing can be written for now: until GoOn() steps and inputs are left out, those that wait first, and
  /// nobody waits for room. `lost`: steps that were taken already and are left out as well.
  void Stall(std::uint64_t lost) EXCLUDES(mutex_);
  void GoOn() EXCLUDES(mutex_);
  /// Waits a short while. True: Close() was called.
  bool WaitStalled() EXCLUDES(mutex_);

  // --- any thread
  /// No more is taken; what waits stays. Nobody waits for room any more.
  void Close() EXCLUDES(mutex_);
  /// Everything that waits and comes is dropped.
  void Fail() EXCLUDES(mutex_);
  /// Steps left out so far.
  std::uint64_t lost() const EXCLUDES(mutex_);
  /// Those after which nothing was recorded any more; 0 from then on.
  std::uint64_t TakeLostAtEnd() EXCLUDES(mutex_);

 private:
  bool refuses() const REQUIRES(mutex_) { return closed_ || failed_; }
  bool waits() const REQUIRES(mutex_) { return !refuses() && !stalled_; }
  bool HasRoom(std::size_t bytes) const REQUIRES(mutex_) {
    return items_.empty() || bytes_ + bytes <= max_bytes_;
  }
  void Push(QueuedItem item) REQUIRES(mutex_);
  /// Input or event; false if there is no room.
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
  std::deque<Nanoseconds> uncommitted_ GUARDED_BY(mutex_);  // when these steps ran, also those taken
  std::size_t taken_ GUARDED_BY(mutex_) = 0;                // of uncommitted_
  int begins_ GUARDED_BY(mutex_) = 0;                       // among items_
  bool beginning_ GUARDED_BY(mutex_) = false;               // the recorder makes the file that it took last
  bool closed_ GUARDED_BY(mutex_) = false, failed_ GUARDED_BY(mutex_) = false;
  bool stalled_ GUARDED_BY(mutex_) = false;
  bool sleeping_ GUARDED_BY(mutex_) = false;        // the recorder, until it is told
  bool needs_keyframe_ GUARDED_BY(mutex_) = false;  // something was left out
  std::uint64_t lost_ GUARDED_BY(mutex_) = 0, lost_since_ GUARDED_BY(mutex_) = 0;
  std::optional<std::uint64_t> keyframe_ GUARDED_BY(mutex_);  // step of the last; empty: nothing has begun
};

}  // namespace coopdyn
