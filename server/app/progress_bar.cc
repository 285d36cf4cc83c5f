// SPDX-License-Identifier: MIT
#include "server/app/progress_bar.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/log.h"

namespace coopdyn {

constexpr Nanoseconds kFirstBar = kNanosecondsPerSecond, kBarPeriod = kNanosecondsPerSecond / 5;

ProgressBar::ProgressBar(const Clock& clock, Logger logger)
    : clock_(clock),
      logger_(std::move(logger)),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(clock.Now()),
      next_(start_ + kFirstBar) {}

ProgressBar::~ProgressBar() {
  ShowBelowLog(logger_, "");
}

void ProgressBar::Show(double share) {
  if (!terminal_) return;
  const Nanoseconds now = clock_.Now();
  if (now < next_) return;
  next_ = now + kBarPeriod;
  ShowBelowLog(logger_, ProgressText(share, ToSeconds(now - start_)));
}

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

std::string ProgressText(double share, double elapsed_s) {
  const double done = std::clamp(share, 0.0, 1.0);
  std::string text = fmt::format("{} {:3.0f} %", BarText(done), std::floor(100 * done));
  if (done > 0 && done < 1) text += "  " + LeftText(elapsed_s * (1 - done) / done);
  return text;
}

}  // namespace coopdyn
