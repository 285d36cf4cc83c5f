// SPDX-License-Identifier: MIT
#include "server/timing/pace.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace coopdyn {

void Pacer::Start(Nanoseconds now, Nanoseconds step, double speed) {
  start_ = now;
  period_ns_ = std::max(1.0, static_cast<double>(step) / speed);
  ticks_ = 1;
}

Nanoseconds Pacer::due() const {
  return start_ + std::llround(static_cast<double>(ticks_) * period_ns_);
}

std::int64_t Pacer::Advance(Nanoseconds now) {
  const auto reached = static_cast<std::int64_t>(std::floor(static_cast<double>(now - start_) / period_ns_));
  const std::int64_t skipped = std::max<std::int64_t>(0, reached - ticks_);
  ticks_ += skipped + 1;
  return skipped;
}

void RateMeter::Note(Nanoseconds now, Nanoseconds simulated) {
  if (!samples_.empty() && now - samples_.back().wall < kSampleEvery) return;
  samples_.push_back({now, simulated});
  while (samples_.size() > 2 && now - samples_[1].wall >= kWindow) samples_.pop_front();
}

double RateMeter::Factor(Nanoseconds now, Nanoseconds simulated) const {
  if (samples_.empty()) return 0;
  // The window of a world that stands still has no recent samples: include the standstill.
  Sample oldest = samples_.front();
  for (const Sample& sample : samples_) {
    if (now - sample.wall < kWindow) break;
    oldest = sample;
  }
  const Nanoseconds wall = now - oldest.wall;
  return wall <= 0 ? 0 : static_cast<double>(simulated - oldest.simulated) / static_cast<double>(wall);
}

// On Linux, 0 means the calling thread, not its process.
UrgentThread::UrgentThread() : usual_(getpriority(PRIO_PROCESS, 0)) {}

bool UrgentThread::Set(bool urgent) {
  // About ten times the weight of a usual thread, but not real-time scheduling: an endless loop must not
  // block the machine.
  constexpr int kUrgent = -10;
  if (urgent == urgent_) return true;
  urgent_ = urgent;
  return setpriority(PRIO_PROCESS, 0, urgent ? std::min(usual_, kUrgent) : usual_) == 0;
}

}  // namespace coopdyn
