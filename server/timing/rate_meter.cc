// SPDX-License-Identifier: MIT
#include "server/timing/rate_meter.h"

namespace coopdyn {

void RateMeter::Note(Nanoseconds now, Nanoseconds simulated) {
  if (!samples_.empty() && now - samples_.back().wall < kSampleEvery) return;
  samples_.push_back({now, simulated});
  while (samples_.size() > 2 && now - samples_[1].wall >= kWindow) samples_.pop_front();
}

double RateMeter::Factor(Nanoseconds now, Nanoseconds simulated) const {
  if (samples_.empty()) return 0;
  // A world that stands still has fewer samples than a window holds: count the stand-still in.
  Sample oldest = samples_.front();
  for (const Sample& sample : samples_) {
    if (now - sample.wall < kWindow) break;
    oldest = sample;
  }
  const Nanoseconds wall = now - oldest.wall;
  return wall <= 0 ? 0 : static_cast<double>(simulated - oldest.simulated) / static_cast<double>(wall);
}

}  // namespace coopdyn
