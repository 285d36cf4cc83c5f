// SPDX-License-Identifier: MIT
// Wakes one sleeping thread. A ring between reading count() and WaitUntil() is never lost. Any thread rings.
#pragma once

#include <cstdint>

#include "server/base/clock.h"
#include "server/base/mutex.h"

namespace coopdyn {

class Doorbell {
 public:
  void Ring() EXCLUDES(mutex_);
  std::uint64_t count() const EXCLUDES(mutex_);
  /// Returns when the bell has been rung since `seen`, or at `deadline` of the steady clock (INT64_MAX:
  /// never).
  void WaitUntil(std::uint64_t seen, Nanoseconds deadline) EXCLUDES(mutex_);

 private:
  mutable Mutex mutex_;
  ConditionVariable rung_;
  std::uint64_t count_ GUARDED_BY(mutex_) = 0;
};

}  // namespace coopdyn
