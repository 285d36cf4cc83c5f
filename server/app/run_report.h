// SPDX-License-Identifier: MIT
// What is told about a run while it goes on and when it has ended. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "server/state/frame.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// How a run stands, or has ended.
struct RunReport {
  FramePtr frame;  // the newest
  RunStatus status;
  std::optional<RunEnd> end;  // empty: it goes on
  StoppedRobots stopped;
  std::map<std::string, Logged> logged;
  bool recording_failed = false;
  std::map<std::string, std::string> digests;  // of what it ran, as it began
  double wall_s = 0;                           // that the run took
};

/// DigestsOf() a run that begins with `frame`, in this program. Reads files.
std::map<std::string, std::string> DigestsNow(const Frame& frame);

/// "t = 12.00 s  step 1200  real-time factor 3.2"; with a duration "t = 12.00 of 60 s …  15 s left".
std::string ProgressLine(const RunReport& run);
/// A bar of 40 characters up to the duration, and the progress line; for a terminal.
std::string ProgressWithBar(const RunReport& run);
/// "1200 steps of 100 robots, t = 12.00 s in 1.48 s, real-time factor 8.1, hash …" and what went wrong.
std::string SummaryLine(const RunReport& run);
/// What `--summary` writes: one JSON object.
std::string SummaryJson(const RunReport& run);
/// Of a run that has ended: kExitOk, kExitFaulty or kExitCutShort.
int ExitCode(const RunReport& run);

/// Puts `text` in place of `file` as a whole, or writes it to a device. An error text, empty if it is there.
std::string WriteSummary(const std::string& file, const std::string& text);

}  // namespace coopdyn
