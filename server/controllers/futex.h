// SPDX-License-Identifier: MIT
// Waiting for a word of shared memory to change, across processes. Any thread.
#pragma once

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <ctime>

#include "server/base/clock.h"

namespace coopdyn {

/// Sleeps until somebody wakes waiters of `word`, but not if it is not `value` any more. May return early.
/// `at_most` 0: without limit.
inline void FutexWait(const std::atomic<std::uint32_t>& word, std::uint32_t value, Nanoseconds at_most) {
  timespec limit{};
  limit.tv_sec = at_most / kNanosecondsPerSecond;
  limit.tv_nsec = at_most % kNanosecondsPerSecond;
  syscall(SYS_futex, &word, FUTEX_WAIT, value, at_most == 0 ? nullptr : &limit, nullptr, 0);
}

/// Wakes one waiter.
inline void FutexWake(std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

}  // namespace coopdyn
