// SPDX-License-Identifier: MIT
#include "server/app/progress_bar.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/app/progress_text.h"
#include "server/base/log_bar.h"

namespace coopdyn {

namespace {

constexpr Nanoseconds kFirst = 1'000'000'000, kPeriod = 200'000'000;

}  // namespace

ProgressBar::ProgressBar(const Clock& clock, Logger logger)
    : clock_(clock),
      logger_(std::move(logger)),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(clock.Now()),
      next_(start_ + kFirst) {}

ProgressBar::~ProgressBar() {
  ShowBelowLog(logger_, "");
}

void ProgressBar::Show(double share) {
  if (!terminal_) return;
  const Nanoseconds now = clock_.Now();
  if (now < next_) return;
  next_ = now + kPeriod;
  ShowBelowLog(logger_, ProgressText(share, ToSeconds(now - start_)));
}

std::string ProgressText(double share, double elapsed_s) {
  const double done = std::clamp(share, 0.0, 1.0);
  std::string text = fmt::format("{} {:3.0f} %", BarText(done), std::floor(100 * done));
  if (done > 0 && done < 1) text += "  " + LeftText(elapsed_s * (1 - done) / done);
  return text;
}

}  // namespace coopdyn
