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

/// "[####....]  42 %  12 s left"; `elapsed_s` is what the share took.
std::string ProgressText(double share, double elapsed_s);

}  // namespace coopdyn
