// SPDX-License-Identifier: MIT
// Timekeeping: when the next step is due, the real-time factor, and the priority of the stepping thread. The
// caller passes the time. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "server/base/clock.h"

namespace coopdyn {

/// Paces steps of `step` simulated nanoseconds at `speed` times the wall clock, by absolute deadlines, so
/// errors do not accumulate. A late step runs at once. Missed whole periods are skipped and counted, never
/// run in a burst.
class Pacer {
 public:
  /// Restarts: the first step is due one period after `now`. `speed` > 0.
  void Start(Nanoseconds now, Nanoseconds step, double speed);
  bool started() const { return period_ns_ > 0; }
  void Stop() { period_ns_ = 0; }

  /// When the next step is due.
  Nanoseconds due() const;
  /// Notes that the due step has begun at `now`. Returns the number of skipped periods.
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
  /// Simulated over wall time in the window that ends at `now`; 0 before the first Note().
  double Factor(Nanoseconds now, Nanoseconds simulated) const;
  void Reset() { samples_.clear(); }

 private:
  struct Sample {
    Nanoseconds wall = 0, simulated = 0;
  };
  std::deque<Sample> samples_;  // at most one per kSampleEvery; the oldest is about kWindow old
};

/// Raises a thread's priority: timekeeping must not queue behind other programs of a busy machine.
class UrgentThread {
 public:
  /// For the calling thread, which makes all calls.
  UrgentThread();
  /// Set(false).
  ~UrgentThread() { Set(false); }
  UrgentThread(const UrgentThread&) = delete;
  UrgentThread& operator=(const UrgentThread&) = delete;

  /// Sets a high or the usual priority; does nothing if unchanged. Returns false if the system refuses.
  bool Set(bool urgent);

 private:
  const int usual_;  // nice value
  bool urgent_ = false;
};

}  // namespace coopdyn
