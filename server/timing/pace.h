// SPDX-License-Identifier: MIT
// Keeping time: when the next step is due, how fast the world goes, and a thread that is not kept waiting.
// The caller says what time it is. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "server/base/clock.h"

namespace coopdyn {

/// Paces steps of `step` simulated nanoseconds at `speed` times the wall clock, by absolute deadlines, so
/// that errors do not add up. A late step is run at once; whole periods that were missed are skipped and
/// counted, never run in a burst.
class Pacer {
 public:
  /// Starts anew: the first step is due one period after `now`. `speed` > 0.
  void Start(Nanoseconds now, Nanoseconds step, double speed);
  bool started() const { return period_ns_ > 0; }
  void Stop() { period_ns_ = 0; }

  /// When the next step is due.
  Nanoseconds due() const;
  /// Says that the step which was due has begun at `now`; returns how many periods had to be skipped.
  std::int64_t Advance(Nanoseconds now);

 private:
  Nanoseconds start_ = 0;
  double period_ns_ = 0;    // wall time of one step; 0: not started
  std::int64_t ticks_ = 1;  // the next deadline is start_ + ticks_ × period
};

/// The real-time factor over the last second of wall time.
class RateMeter {
 public:
  static constexpr Nanoseconds kWindow = kNanosecondsPerSecond;
  static constexpr Nanoseconds kSampleEvery = 10'000'000;

  /// Notes that the simulated time is `simulated` at wall time `now`.
  void Note(Nanoseconds now, Nanoseconds simulated);
  /// Simulated over wall time in the window that ends at `now`; 0 without two notes.
  double Factor(Nanoseconds now, Nanoseconds simulated) const;
  void Reset() { samples_.clear(); }

 private:
  struct Sample {
    Nanoseconds wall = 0, simulated = 0;
  };
  std::deque<Sample> samples_;  // at most one each kSampleEvery, the oldest about kWindow ago
};

/// A thread that keeps time must not queue behind the other programs of a busy machine.
class UrgentThread {
 public:
  /// Of the calling thread, which makes all calls.
  UrgentThread();
  /// Set(false).
  ~UrgentThread() { Set(false); }
  UrgentThread(const UrgentThread&) = delete;
  UrgentThread& operator=(const UrgentThread&) = delete;

  /// Ahead of usual programs, or as before. False if the system refuses it; without a change nothing is
  /// asked.
  bool Set(bool urgent);

 private:
  const int usual_;  // nice value
  bool urgent_ = false;
};

}  // namespace coopdyn
