// SPDX-License-Identifier: MIT
// `coopdyn bench robot`: cost of a step of one type of robot, for any number of copies.
#pragma once

#include <string>

#include "tests/bench/bench_swarm.h"

namespace coopdyn {

/// The options of a run of `copies` robots of `type` in fidelity full, 4 m apart, without walls. They act by
/// their kind: legs walk, arms reach; `controller` replaces that; with none they stand still.
SwarmBenchOptions RobotBenchOptions(const std::string& type, int copies, const std::string& controller);

/// One JSON object, ended by '\n'; a table for people.
std::string RobotBenchJson(const SwarmBenchOptions& options, const SwarmBenchResult& result);
std::string RobotBenchTable(const SwarmBenchOptions& options, const SwarmBenchResult& result);

}  // namespace coopdyn
