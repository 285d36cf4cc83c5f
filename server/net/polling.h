// SPDX-License-Identifier: MIT
// When a thread polls before it sleeps. A poll saves the wake-up while a core is free. Where others want the
// core, polls use up the thread's share of it, and the kernel takes the core away for milliseconds.
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
  /// A poll that takes longer may have been cut in two: NoteLongPoll().
  static constexpr Nanoseconds kLongPoll = std::chrono::microseconds(500);
  static constexpr Nanoseconds kLeastPause = std::chrono::milliseconds(10);
  static constexpr Nanoseconds kMostPause = std::chrono::seconds(1);

  /// True if the thread is to poll now: something came less than `spin` ago, and it has not just lost its
  /// core.
  bool Pays(Time now, Nanoseconds spin) const { return now - active_at_ < spin && now >= resumes_at_; }
  /// True if the thread is to yield the core between two looks: where others want the core, it loses it at
  /// once then. A yield costs as much as a look, so once it has kept its core for a while, only the second
  /// half of the spin has them.
  bool Yields(Time now, Nanoseconds spin) const {
    return now - resumes_at_ < kTrial || now - active_at_ > spin / 2;
  }
  void NoteActivity(Time now) { active_at_ = now; }
  /// After a long poll, whatever it ran. `losses`: how often the kernel has taken the core from the thread so
  /// far. If it has since the last long poll, polling pauses: twice as long each time, if it loses the core
  /// soon after a pause.
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
