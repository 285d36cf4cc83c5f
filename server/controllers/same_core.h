// SPDX-License-Identifier: MIT
// Two processes that take turns, on one core: a wake-up on another core that sleeps costs some 40 µs of both,
// the switch on the same core 1.5 µs where they yield it to each other, 2.7 µs with sleep and wake-up. Going
// to a core and leaving it costs 10 µs, so that it is left only when no turn follows at once, or after many
// turns, so that the system may find a better one (docs/decisions.md). What the system refuses is left as it
// is.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <algorithm>
#include <thread>

#include "server/base/clock.h"

namespace coopdyn {

/// One caller at a time, whichever thread it is.
class SameCore {
 public:
  /// For turns with the main thread of process `other`.
  explicit SameCore(pid_t other) : other_(other) {}
  /// Leave(); the other stays where it is.
  ~SameCore() { Leave(); }
  SameCore(const SameCore&) = delete;
  SameCore& operator=(const SameCore&) = delete;

  /// A turn: the calling thread and the other stay on the core where the caller is now, with its priority.
  void Take();
  /// Whether both are held and yield the core, rather than sleep, until the other has had its turn. Not in
  /// the first turn, since the other sleeps then, and perhaps no more follow; and not where other programs
  /// want the core too: each yield gives them milliseconds.
  bool Yields(Nanoseconds now) const { return turns_ > 0 && goes_on_ && now >= resumes_at_; }
  /// How long a turn with yields took. After a long one there are none for a while: twice as long each time,
  /// if it comes soon after the last pause.
  void NoteTurn(Nanoseconds begun, Nanoseconds now) {
    if (now - begun < kLongTurn) return;
    pause_ = begun - resumes_at_ < kTrial ? std::min(2 * pause_, kMostPause) : kLeastPause;
    resumes_at_ = now + pause_;
  }
  /// No turn follows at once: the thread that took the last may go where it could before.
  void Leave();
  /// Leave(), and the other may go wherever the caller may; it has the caller's priority all the same.
  void Free();

 private:
  static constexpr Nanoseconds kLongTurn = 1'000'000;
  static constexpr Nanoseconds kLeastPause = 10'000'000, kMostPause = 1'000'000'000, kTrial = 300'000'000;

  /// All threads of the other process, if it leads a group of its own, get the caller's priority.
  void SharePriority();
  /// The thread that took the last turn may go where it could before.
  void Release();

  const pid_t other_;
  int nice_ = 0;            // of the other, as set last
  int other_core_ = -1;     // on which the other has been put; -1: it is free
  int turns_ = 0;           // since the caller is held
  bool taken_ = false;      // a turn, since Leave()
  bool goes_on_ = false;    // two turns, since Leave()
  std::thread::id thread_;  // the caller
  pid_t tid_ = 0;           // the same
  cpu_set_t before_{};      // where it could go
  Nanoseconds pause_ = kLeastPause;
  Nanoseconds resumes_at_ = 0;  // no yields before
};

}  // namespace coopdyn
