// SPDX-License-Identifier: MIT
// Two processes that take turns, on one core: a wake-up on another core that sleeps costs some 40 µs of both,
// the switch on the same core 2 µs (docs/decisions.md).
#pragma once

#include <sched.h>
#include <sys/types.h>

namespace coopdyn {

/// While it lives, the calling thread and the main thread of process `other` stay on the core where the
/// caller is now; afterwards the caller may go where it could before. `other_core`: the core on which `other`
/// has been left by the last one, −1 at first. What the system refuses is left as it is.
class SameCore {
 public:
  SameCore(pid_t other, int& other_core) {
    const int core = sched_getcpu();
    if (core < 0 || core >= CPU_SETSIZE || sched_getaffinity(0, sizeof(before_), &before_) != 0) return;
    cpu_set_t here;
    CPU_ZERO(&here);
    CPU_SET(static_cast<std::size_t>(core), &here);
    if (other_core != core && sched_setaffinity(other, sizeof(here), &here) != 0) return;
    other_core = core;
    held_ = sched_setaffinity(0, sizeof(here), &here) == 0;
  }
  ~SameCore() {
    if (held_) sched_setaffinity(0, sizeof(before_), &before_);
  }
  /// Lets `other` go wherever the calling thread may.
  static void Free(pid_t other, int& other_core) {
    cpu_set_t all;
    if (sched_getaffinity(0, sizeof(all), &all) == 0) sched_setaffinity(other, sizeof(all), &all);
    other_core = -1;
  }
  SameCore(const SameCore&) = delete;
  SameCore& operator=(const SameCore&) = delete;

 private:
  cpu_set_t before_{};
  bool held_ = false;
};

}  // namespace coopdyn
