// SPDX-License-Identifier: MIT
// The real-time factor over the last second of wall time. Pure: the caller says what time it is. One thread.
#pragma once

#include <cstddef>
#include <deque>

#include "server/base/clock.h"

namespace coopdyn {

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

}  // namespace coopdyn
