// SPDX-License-Identifier: MIT
// What is told about a run while it goes on and when it has ended. Pure functions.
#pragma once

#include <string>

#include "server/state/frame.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// "t = 12.00 s  step 1200  real-time factor 3.2"; with `duration_s` > 0 "t = 12.00 of 60 s …  15 s left".
std::string ProgressLine(const Frame& frame, const RunStatus& status, double duration_s);
/// A bar of 40 characters up to `duration_s`, and the progress line; for a terminal.
std::string ProgressWithBar(const Frame& frame, const RunStatus& status, double duration_s);
/// "1200 steps of 100 robots, t = 12.00 s in 1.48 s, real-time factor 8.1, hash …" and what was frozen.
std::string SummaryLine(const Frame& frame, const RunStatus& status, double wall_s);
/// What `--summary` writes: one JSON object. `wall_s`: how long the run took.
std::string SummaryJson(const Frame& frame, const RunStatus& status, double wall_s);

}  // namespace coopdyn
