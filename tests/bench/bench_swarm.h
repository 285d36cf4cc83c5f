// SPDX-License-Identifier: MIT
// `coopdyn bench swarm`: robot-steps per second of CPU, without sockets, pictures or pacing.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/bench_arena.h"

namespace coopdyn {

struct SwarmBenchOptions {
  ArenaOptions arena;
  int threads = 1;
  double seconds = 10;  // simulated, of each repeat
  int repeats = 3;
  bool controllers_in_process = false;
  std::string program = {};  // becomes the controllers' child; empty: the coopdyn beside this program
};

/// Where a robot-step spends its time, µs of wall time.
struct BenchSplit {
  double sense_us = 0, control_us = 0, physics_us = 0, publish_us = 0, other_us = 0;
};

/// One repeat, from the first step to the last, or the medians of several.
struct BenchFigures {
  double robot_steps_per_cpu_s = 0;  // CPU time of all threads and of the controllers' child
  double robot_steps_per_wall_s = 0;
  double rtf = 0;  // simulated time / wall time
  BenchSplit split;
};

struct SwarmBenchResult {
  BenchFigures median;
  double spread = 0;  // of robot_steps_per_cpu_s: (largest − smallest) / median
  std::uint64_t steps = 0;
  int rays = 0;                       // of one robot
  double range_m = 0;                 // of its first sensor
  double kb_per_robot = 0;            // growth of this process in the first repeat, without the robot's model
  std::vector<std::string> hashes;    // of the last frame, by repeat
  std::vector<std::string> frozen;    // bodies that exploded
  std::vector<std::string> problems;  // errors of the run, e.g. controllers that were stopped
  bool hashes_agree() const;
};

/// Runs the benchmark, with a new world for each repeat. Calls `tell` before each repeat with its number from
/// 1. Returns nullopt, with errors, if the world cannot be built. The calling thread steps.
std::optional<SwarmBenchResult> RunSwarmBench(const SwarmBenchOptions& options, RobotLibrary& library,
                                              Diagnostics& diagnostics,
                                              const std::function<void(int)>& tell = {});

/// One JSON object, followed by '\n'; or a table for people.
std::string BenchJson(const SwarmBenchOptions& options, const SwarmBenchResult& result);
std::string BenchTable(const SwarmBenchOptions& options, const SwarmBenchResult& result);

}  // namespace coopdyn
