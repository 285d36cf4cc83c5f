// SPDX-License-Identifier: MIT
// Wall-clock time as an argument: the steady clock of the machine, or one that tests own.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace coopdyn {

/// Nanoseconds; simulated or wall time according to the name that holds them.
using Nanoseconds = std::int64_t;
inline constexpr Nanoseconds kNanosecondsPerSecond = 1'000'000'000;

/// `ns` as seconds: the one conversion used for every time_s. A division is rounded once, so that 6.68 s is
/// the double nearest to 6.68 and prints so.
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

/// A clock that stands still until told. Any thread.
class ManualClock final : public Clock {
 public:
  Nanoseconds Now() const override { return now_.load(); }
  void Advance(Nanoseconds by) { now_ += by; }

 private:
  std::atomic<Nanoseconds> now_{0};
};

}  // namespace coopdyn
