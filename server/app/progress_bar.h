// SPDX-License-Identifier: MIT
// A bar on stderr for what takes longer than a second; nothing where stderr is no terminal. One thread.
#pragma once

#include <string>

#include "server/base/clock.h"
#include "server/base/log.h"

namespace coopdyn {

class ProgressBar {
 public:
  /// Below the lines of `logger`, that of a LogBackend. `clock` outlives it.
  ProgressBar(const Clock& clock, Logger logger);
  /// Wipes the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Draws it now and then. `share` done: 0…1.
  void Show(double share);

 private:
  const Clock& clock_;
  const Logger logger_;
  const bool terminal_;
  const Nanoseconds start_;
  Nanoseconds next_;
};

// The pieces that progress is told with. Pure functions.
/// "[####....]", 40 characters wide; `share` done: 0…1.
std::string BarText(double share);
/// "45 s left", "12 min left" or "3.1 h left".
std::string LeftText(double seconds);
/// "[####....]  42 %  12 s left"; `elapsed_s` is what the share took.
std::string ProgressText(double share, double elapsed_s);

}  // namespace coopdyn
