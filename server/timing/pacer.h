// SPDX-License-Identifier: MIT
// When the next step is due. Pure: the caller says what time it is. One thread.
#pragma once

#include <cstdint>

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

}  // namespace coopdyn
