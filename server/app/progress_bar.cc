// SPDX-License-Identifier: MIT
#include "server/app/progress_bar.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace coopdyn {

namespace {

constexpr Nanoseconds kFirst = 1'000'000'000, kPeriod = 200'000'000;

/// "45 s", "12 min" or "3.1 h".
std::string Rough(double seconds) {
  constexpr double kMinute_s = 60, kHour_s = 3600;
  if (seconds < 2 * kMinute_s) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2 * kHour_s) return fmt::format("{:.0f} min", seconds / kMinute_s);
  return fmt::format("{:.1f} h", seconds / kHour_s);
}

}  // namespace

ProgressBar::ProgressBar(const Clock& clock)
    : clock_(clock), terminal_(::isatty(STDERR_FILENO) == 1), start_(clock.Now()), next_(start_ + kFirst) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::cerr << "\r\033[K" << std::flush;
}

void ProgressBar::Show(double share) {
  if (!terminal_) return;
  const Nanoseconds now = clock_.Now();
  if (now < next_) return;
  next_ = now + kPeriod;
  drawn_ = true;
  std::cerr << '\r' << ProgressText(share, ToSeconds(now - start_)) << "\033[K" << std::flush;
}

std::string ProgressText(double share, double elapsed_s) {
  constexpr int kWidth = 40;
  const double done = std::clamp(share, 0.0, 1.0);
  const auto marks = static_cast<std::size_t>(std::lround(kWidth * done));
  std::string text = fmt::format("[{}{}] {:3.0f} %", std::string(marks, '#'),
                                 std::string(kWidth - marks, '.'), std::floor(100 * done));
  if (done > 0 && done < 1) text += "  " + Rough(elapsed_s * (1 - done) / done) + " left";
  return text;
}

}  // namespace coopdyn
