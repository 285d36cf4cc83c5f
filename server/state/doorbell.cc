// SPDX-License-Identifier: MIT
#include "server/state/doorbell.h"

#include <chrono>
#include <limits>

namespace coopdyn {

void Doorbell::Ring() {
  {
    const MutexLock lock(mutex_);
    ++count_;
  }
  rung_.NotifyOne();
}

std::uint64_t Doorbell::count() const {
  const MutexLock lock(mutex_);
  return count_;
}

void Doorbell::WaitUntil(std::uint64_t seen, Nanoseconds deadline) {
  const MutexLock lock(mutex_);
  if (deadline == std::numeric_limits<Nanoseconds>::max()) {
    while (count_ == seen) rung_.Wait(mutex_);
    return;
  }
  const std::chrono::steady_clock::time_point until{std::chrono::nanoseconds(deadline)};
  while (count_ == seen) {
    if (!rung_.WaitUntil(mutex_, until)) return;
  }
}

}  // namespace coopdyn
