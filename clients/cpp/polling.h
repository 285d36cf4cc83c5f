// SPDX-License-Identifier: MIT
// Decides when a client polls before it blocks. Polling saves the wake-up latency while a core is idle. If
// other threads compete for the core, polling uses up the client's share, and the kernel preempts it for
// milliseconds.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "clients/cpp/address.h"

namespace coopdyn::client {

/// Polls for a while at the start of each wait. Once preempted while polling, stops polling for a pause,
/// which doubles if preempted again soon after it.
class Polling {
 public:
  void set_spin(double spin_s) { spin_ = After(spin_s, Deadline{}) - Deadline{}; }
  /// Begins a wait.
  void Start(Deadline now) {
    until_ = now >= resumes_at_ ? now + spin_ : now;
    looked_at_ = now;
  }
  /// Call after each check of the sockets. True if the caller must check again immediately.
  bool ShouldPollAgain(Deadline now) {
    if (looked_at_ < until_ && now - looked_at_ > kLost) {
      pause_ = now - resumes_at_ < kTrial ? std::min(2 * pause_, kMostPause) : kLeastPause;
      resumes_at_ = now + pause_;
      until_ = now;
    }
    looked_at_ = now;
    if (now >= until_) return false;
    // If other threads want the core, a yield loses it at once, which shows here. A yield costs as much as a
    // check, so once the core has been kept for a while, only the second half of the spin yields.
    if (now - resumes_at_ < kTrial || until_ - now < spin_ / 2) std::this_thread::yield();
    return true;
  }

 private:
  static constexpr Clock::duration kLost = std::chrono::microseconds(500);
  static constexpr Clock::duration kTrial = std::chrono::milliseconds(300);
  static constexpr Clock::duration kLeastPause = std::chrono::milliseconds(10);
  static constexpr Clock::duration kMostPause = std::chrono::seconds(1);

  Clock::duration spin_{0};
  Deadline until_{}, looked_at_{}, resumes_at_{};
  Clock::duration pause_ = kLeastPause;
};

}  // namespace coopdyn::client
