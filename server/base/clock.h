// SPDX-License-Identifier: MIT
// Wall-clock time as a dependency: the machine's steady clock, or a clock that a test controls.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace coopdyn {

/// Nanoseconds of simulated or wall time; the variable's name says which.
using Nanoseconds = std::int64_t;
inline constexpr Nanoseconds kNanosecondsPerSecond = 1'000'000'000;

/// `ns` in seconds: the conversion behind every time_s. A division rounds only once, so 6.68 s is the double
/// nearest to 6.68 and prints as 6.68.
inline double ToSeconds(Nanoseconds ns) {
  return static_cast<double>(ns) / 1e9;
}

class Clock {
 public:
  virtual ~Clock() = default;
  /// Monotonic wall-clock time. Any thread.
  virtual Nanoseconds Now() const = 0;
};

/// CLOCK_MONOTONIC.
class SteadyClock final : public Clock {
 public:
  Nanoseconds Now() const override {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  }
};

/// A clock that stands still until Advance(). Any thread.
class ManualClock final : public Clock {
 public:
  Nanoseconds Now() const override { return now_.load(); }
  void Advance(Nanoseconds by) { now_ += by; }

 private:
  std::atomic<Nanoseconds> now_{0};
};

}  // namespace coopdyn
