// SPDX-License-Identifier: MIT
// Wakes one sleeping thread. A ring between reading count() and WaitUntil() is never lost. Any thread may
// ring.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

#include "server/base/clock.h"
#include "server/base/mutex.h"

namespace coopdyn {

class Doorbell {
 public:
  void Ring() EXCLUDES(mutex_) {
    {
      const MutexLock lock(mutex_);
      ++count_;
    }
    rung_.NotifyOne();
  }
  std::uint64_t count() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return count_;
  }
  /// Returns once the bell has been rung since `seen`, or at `deadline` of the steady clock (INT64_MAX:
  /// never).
  void WaitUntil(std::uint64_t seen, Nanoseconds deadline) EXCLUDES(mutex_) {
    const bool forever = deadline == std::numeric_limits<Nanoseconds>::max();
    const std::chrono::steady_clock::time_point until{std::chrono::nanoseconds(deadline)};
    const MutexLock lock(mutex_);
    while (count_ == seen) {
      if (forever) {
        rung_.Wait(mutex_);
      } else if (!rung_.WaitUntil(mutex_, until)) {
        return;
      }
    }
  }

 private:
  mutable Mutex mutex_;
  ConditionVariable rung_;
  std::uint64_t count_ GUARDED_BY(mutex_) = 0;
};

}  // namespace coopdyn
