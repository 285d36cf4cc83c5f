// SPDX-License-Identifier: MIT
// Decides when a thread polls before it sleeps. While a core is free, a poll saves the wake-up. If other
// threads want the core, polling uses up the thread's share, and the kernel preempts the thread for
// milliseconds.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace coopdyn {

/// Used by one thread.
class Polling {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Nanoseconds = std::chrono::nanoseconds;
  /// After a longer poll call NoteLongPoll(): the thread may have been preempted.
  static constexpr Nanoseconds kLongPoll = std::chrono::microseconds(500);
  static constexpr Nanoseconds kLeastPause = std::chrono::milliseconds(10);
  static constexpr Nanoseconds kMostPause = std::chrono::seconds(1);

  /// True if the thread should poll now: there was activity within `spin`, and the thread has not just lost
  /// its core.
  bool Pays(Time now, Nanoseconds spin) const { return now - active_at_ < spin && now >= resumes_at_; }
  /// True if the thread should yield between two polls. A thread that yields loses a contested core at once.
  /// Because a yield costs as much as a poll, a thread that has kept its core for a while yields only in the
  /// second half of the spin.
  bool Yields(Time now, Nanoseconds spin) const {
    return now - resumes_at_ < kTrial || now - active_at_ > spin / 2;
  }
  void NoteActivity(Time now) { active_at_ = now; }
  /// Call after a long poll, whatever it ran. `losses`: how often the kernel has preempted the thread so far.
  /// If that number has grown since the last long poll, polling pauses: twice as long each time if the thread
  /// loses its core soon after a pause.
  void NoteLongPoll(Time now, std::int64_t losses) {
    if (losses == losses_) return;
    losses_ = losses;
    pause_ = now - resumes_at_ < kTrial ? std::min(2 * pause_, kMostPause) : kLeastPause;
    resumes_at_ = now + pause_;
  }

 private:
  static constexpr Nanoseconds kTrial = std::chrono::milliseconds(300);

  Time active_at_{};
  Time resumes_at_{};
  Nanoseconds pause_ = kLeastPause;
  std::int64_t losses_ = 0;
};

}  // namespace coopdyn
