// SPDX-License-Identifier: MIT
#include "server/record/player_pace.h"

#include <cmath>

namespace coopdyn {

void PlayPace::Start(Nanoseconds now, Nanoseconds time, double speed) {
  wall_ = now;
  time_ = time;
  speed_ = speed;
}

Nanoseconds PlayPace::DueTime(Nanoseconds now) const {
  return time_ + static_cast<Nanoseconds>(std::floor(static_cast<double>(now - wall_) * speed_));
}

Nanoseconds PlayPace::WallTime(Nanoseconds time) const {
  const auto ahead = static_cast<double>(time - time_);
  if (speed_ > 0) return wall_ + static_cast<Nanoseconds>(std::ceil(ahead / speed_));
  return wall_ + static_cast<Nanoseconds>(std::floor(ahead / speed_)) + 1;
}

}  // namespace coopdyn
