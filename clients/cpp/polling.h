// SPDX-License-Identifier: MIT
// When a client polls before it waits: that saves the wake-up while a core is free. Where others want the
// core, polls use up the client's share of it, and the kernel takes the core away for milliseconds.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "clients/cpp/address.h"

namespace coopdyn::client {

/// Polls for a while at the start of each wait. Once it lost the core meanwhile, it pauses: twice as long
/// each time, if it loses it soon after a pause.
class Polling {
 public:
  void set_spin(double spin_s) { spin_ = After(spin_s, Deadline{}) - Deadline{}; }
  /// A wait begins.
  void Start(Deadline now) {
    until_ = now >= resumes_at_ ? now + spin_ : now;
    looked_at_ = now;
  }
  /// After each look at the sockets: true if the caller is to look again at once.
  bool Goes(Deadline now) {
    if (looked_at_ < until_ && now - looked_at_ > kLost) {
      pause_ = now - resumes_at_ < kTrial ? std::min(2 * pause_, kMostPause) : kLeastPause;
      resumes_at_ = now + pause_;
      until_ = now;
    }
    looked_at_ = now;
    if (now >= until_) return false;
    // Where others want the core, it is lost at once in a yield. One costs as much as a look, so once the
    // core has been kept for a while, only the second half of the spin has them.
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
