// SPDX-License-Identifier: MIT
// Reports on a run while it runs and after it has ended. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "server/state/frame.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// The state or the result of a run.
struct RunReport {
  FramePtr frame;  // the newest
  RunStatus status;
  std::optional<RunEnd> end;  // nullopt while the run continues
  StoppedRobots stopped;
  std::map<std::string, Logged> logged;
  bool recording_failed = false;
  std::map<std::string, std::string> digests;  // of the run's inputs at its start
  double wall_s = 0;                           // wall time of the run
};

/// DigestsOf() a run of this program that begins with `frame`. Reads files.
std::map<std::string, std::string> DigestsNow(const Frame& frame);

/// "t = 12.00 s  step 1200  real-time factor 3.2"; with a duration "t = 12.00 of 60 s …  15 s left".
std::string ProgressLine(const RunReport& run);
/// A bar of 40 characters up to the duration, and the progress line; for a terminal.
std::string ProgressWithBar(const RunReport& run);
/// "1200 steps of 100 robots, t = 12.00 s in 1.48 s, real-time factor 8.1, hash …" and all failures.
std::string SummaryLine(const RunReport& run);
/// The content of the `--summary` file: one JSON object.
std::string SummaryJson(const RunReport& run);
/// The exit code of an ended run: kExitOk, kExitFaulty or kExitCutShort.
int ExitCode(const RunReport& run);

/// Replaces `file` by `text` atomically, or writes to a device. Returns an error text, empty on success.
std::string WriteSummary(const std::string& file, const std::string& text);

}  // namespace coopdyn
