// SPDX-License-Identifier: MIT
#include "server/timing/pacer.h"

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

}  // namespace coopdyn
