// SPDX-License-Identifier: MIT
// Which moment of a recording is due. Pure: the caller says what time it is. One thread.
#pragma once

#include <cmath>

#include "server/base/clock.h"

namespace coopdyn {

/// Simulated time that runs at `speed` times the wall clock from where it was set.
class PlayPace {
 public:
  /// At wall time `now` the moment `time` is due. `speed` is not 0; below 0: backwards.
  void Start(Nanoseconds now, Nanoseconds time, double speed) {
    wall_ = now;
    time_ = time;
    speed_ = speed;
  }
  double speed() const { return speed_; }
  /// The simulated time that is due at wall time `now`.
  Nanoseconds DueTime(Nanoseconds now) const {
    return time_ + static_cast<Nanoseconds>(std::floor(static_cast<double>(now - wall_) * speed_));
  }
  /// The first moment of wall time at which `time` is due; backwards: at which a moment before it is, so that
  /// the frame of `time` is due no more.
  Nanoseconds WallTime(Nanoseconds time) const {
    const auto ahead = static_cast<double>(time - time_);
    if (speed_ > 0) return wall_ + static_cast<Nanoseconds>(std::ceil(ahead / speed_));
    return wall_ + static_cast<Nanoseconds>(std::floor(ahead / speed_)) + 1;
  }

 private:
  Nanoseconds wall_ = 0, time_ = 0;
  double speed_ = 1;
};

}  // namespace coopdyn
