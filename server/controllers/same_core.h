// SPDX-License-Identifier: MIT
// Keeps two processes that take turns on one core. To wake a sleeping core costs both some 40 µs; a switch on
// the same core costs 1.5 µs if they yield to each other, 2.7 µs with sleep and wake-up. To pin to a core and
// unpin costs 10 µs, so they stay pinned until no turn follows immediately, or for many turns, after which
// the system may find a better core (docs/decisions.md). Ignores calls that the system refuses.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <algorithm>
#include <thread>

#include "server/base/clock.h"

namespace coopdyn {

/// Any thread, one at a time.
class SameCore {
 public:
  /// For turns with the main thread of process `other`.
  explicit SameCore(pid_t other) : other_(other) {}
  /// Calls Leave(); the other process stays on its core.
  ~SameCore() { Leave(); }
  SameCore(const SameCore&) = delete;
  SameCore& operator=(const SameCore&) = delete;

  /// Begins a turn: pins the calling thread and the other to the caller's current core, with the caller's
  /// priority.
  void Take();
  /// Whether both are pinned and should yield the core to each other rather than sleep. Not in the first
  /// turn, when the other sleeps and perhaps no turn follows; and not while other programs want the core,
  /// because each yield gives them milliseconds.
  bool Yields(Nanoseconds now) const { return turns_ > 0 && goes_on_ && now >= resumes_at_; }
  /// Reports the duration of a turn with yields. After a long turn, disables yields for a while: twice as
  /// long each time if the last pause ended recently.
  void NoteTurn(Nanoseconds begun, Nanoseconds now) {
    if (now - begun < kLongTurn) return;
    pause_ = begun - resumes_at_ < kTrial ? std::min(2 * pause_, kMostPause) : kLeastPause;
    resumes_at_ = now + pause_;
  }
  /// No turn follows immediately: unpins the thread that took the last turn.
  void Leave();
  /// Calls Leave() and gives the other the caller's affinity and priority.
  void Free();

 private:
  static constexpr Nanoseconds kLongTurn = 1'000'000;
  static constexpr Nanoseconds kLeastPause = 10'000'000, kMostPause = 1'000'000'000, kTrial = 300'000'000;

  /// Gives all threads of the other process, if it leads its own group, the caller's priority.
  void SharePriority();
  /// Restores the affinity of the thread that took the last turn.
  void Release();

  const pid_t other_;
  int nice_ = 0;            // of the other, as last set
  int other_core_ = -1;     // core of the other; -1: not pinned
  int turns_ = 0;           // since the caller was pinned
  bool taken_ = false;      // at least one turn since Leave()
  bool goes_on_ = false;    // at least two turns since Leave()
  std::thread::id thread_;  // the pinned caller
  pid_t tid_ = 0;           // its system thread id
  cpu_set_t before_{};      // its affinity before
  Nanoseconds pause_ = kLeastPause;
  Nanoseconds resumes_at_ = 0;  // no yields before this time
};

}  // namespace coopdyn
