// SPDX-License-Identifier: MIT
// What of a run is exported. Values; any thread.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct ExportOptions {
  std::optional<double> from_s = {};  // simulated time, both ends included; nothing: to the ends
  std::optional<double> until_s = {};
  /// Names, also of swarms, in any order; nothing: all. The columns stand in the order of the run.
  std::optional<std::vector<std::string>> robots = {};
  std::optional<std::vector<std::string>> objects = {};  // of things that move; nothing: all
  double every_s = 0;                                    // at most one row per so much simulated time; 0: all
  bool overwrite = false;
};

/// Called now and then with the share done, 0…1. False: stop.
using ExportProgress = std::function<bool(double share)>;
/// The error of an export that was stopped so; nothing is left behind.
inline constexpr const char* kExportStopped = "stopped; nothing was written";

}  // namespace coopdyn
