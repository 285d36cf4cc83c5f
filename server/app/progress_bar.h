// SPDX-License-Identifier: MIT
// A progress bar on stderr for work that takes longer than a second; shows nothing if stderr is no terminal.
// One thread.
#pragma once

#include <string>

#include "server/base/clock.h"
#include "server/base/log.h"

namespace coopdyn {

class ProgressBar {
 public:
  /// Shows the bar below the lines of `logger`, a LogBackend's. `clock` must outlive it.
  ProgressBar(const Clock& clock, Logger logger);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Redraws the bar at most five times a second. `share`: completed share, 0…1.
  void Show(double share);

 private:
  const Clock& clock_;
  const Logger logger_;
  const bool terminal_;
  const Nanoseconds start_;
  Nanoseconds next_;
};

// Parts of a progress line. Pure functions.
/// "[####....]", 40 characters wide; `share`: completed share, 0…1.
std::string BarText(double share);
/// "45 s left", "12 min left" or "3.1 h left".
std::string LeftText(double seconds);
/// "[####....] 42 % 12 s left"; `elapsed_s`: time taken for `share`.
std::string ProgressText(double share, double elapsed_s);

}  // namespace coopdyn
