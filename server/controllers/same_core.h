// SPDX-License-Identifier: MIT
// Two processes that take turns, on one core: a wake-up on another core that sleeps costs some 40 µs of both,
// the switch on the same core 2 µs. Going to a core and leaving it costs 10 µs, so that it is left only when
// no turn follows at once, or after many turns, so that the system may find a better one
// (docs/decisions.md). What the system refuses is left as it is.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <thread>

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
  /// No turn follows at once: the thread that took the last may go where it could before.
  void Leave();
  /// Leave(), and the other may go wherever the caller may; it has the caller's priority all the same.
  void Free();

 private:
  /// All threads of the other process, if it leads a group of its own, get the caller's priority.
  void SharePriority();

  const pid_t other_;
  int nice_ = 0;            // of the other, as set last
  int other_core_ = -1;     // on which the other has been put; -1: it is free
  int turns_ = 0;           // since the caller is held
  std::thread::id thread_;  // the caller
  pid_t tid_ = 0;           // the same
  cpu_set_t before_{};      // where it could go
};

}  // namespace coopdyn
