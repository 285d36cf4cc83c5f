// SPDX-License-Identifier: MIT
// One repeat of `coopdyn bench swarm`: a world stepped in free mode from start to end, and its cost.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/scenario.h"
#include "server/state/run_control.h"
#include "server/state/run_journal.h"

namespace coopdyn {

struct BenchRunOptions {
  double seconds = 10;  // simulated
  int threads = 1;
  bool controllers_in_process = false;
  std::string program = {};       // becomes the controllers' child; empty: the coopdyn beside this program
  RunJournal* journal = nullptr;  // null: the run is not recorded
  bool sense = false;  // compute all distances after each step; for robots whose controller does not
};

struct BenchRun {
  std::uint64_t steps = 0;
  double simulated_s = 0;
  double cpu_s = 0;  // of this process and of the controllers' child
  double wall_s = 0;
  PhaseTimes phases;
  std::uint64_t hash = 0;
  double resident_kb = 0;  // of this process at the end, before the world is destroyed
  std::vector<std::string> frozen;
  std::vector<std::string> problems;
};

/// Steps `scenario` on the calling thread. Robots without a controller get random wheel speeds once. Returns
/// nullopt, with errors, if the world cannot be built.
std::optional<BenchRun> RunOnce(const std::shared_ptr<const Scenario>& scenario,
                                const BenchRunOptions& options, Diagnostics& diagnostics);

}  // namespace coopdyn
