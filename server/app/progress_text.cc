// SPDX-License-Identifier: MIT
#include "server/app/progress_text.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace coopdyn {

std::string BarText(double share) {
  constexpr int kWidth = 40;
  const auto marks = static_cast<std::size_t>(std::lround(kWidth * std::clamp(share, 0.0, 1.0)));
  return fmt::format("[{}{}]", std::string(marks, '#'), std::string(kWidth - marks, '.'));
}

std::string LeftText(double seconds) {
  constexpr double kMinute_s = 60, kHour_s = 3600;
  if (seconds < 2 * kMinute_s) return fmt::format("{:.0f} s left", seconds);
  if (seconds < 2 * kHour_s) return fmt::format("{:.0f} min left", seconds / kMinute_s);
  return fmt::format("{:.1f} h left", seconds / kHour_s);
}

}  // namespace coopdyn
