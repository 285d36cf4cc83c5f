// SPDX-License-Identifier: MIT
// `coopdyn bench robot`: what a step of one type of robot costs, however many copies there are.
#pragma once

#include <string>

#include "tests/bench/bench_swarm.h"

namespace coopdyn {

/// The options of a run of `copies` robots of `type` in fidelity full, each 4 m from the next, without walls.
/// They do what their kind does: legs walk, arms reach; `controller` replaces that, and none: they stand.
SwarmBenchOptions RobotBenchOptions(const std::string& type, int copies, const std::string& controller);

/// One JSON object, ended by '\n'; a table for people.
std::string RobotBenchJson(const SwarmBenchOptions& options, const SwarmBenchResult& result);
std::string RobotBenchTable(const SwarmBenchOptions& options, const SwarmBenchResult& result);

}  // namespace coopdyn
