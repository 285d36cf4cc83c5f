// SPDX-License-Identifier: MIT
// The client that `coopdyn bench lockstep` measures with: a separate process that drives all robots by the
// C++ or Python client library, as a user would.
#pragma once

#include <string>

#include "tests/bench/bench_daemon.h"

namespace coopdyn {

struct BenchClientOptions {
  bool batch = false;   // one team, else one connection per robot
  bool python = false;  // else C++
  int robots = 100;
  bool readings = false;  // distances with every round; a team always reads poses
  bool at_rest = false;   // every command is 0, else the robots wander
  int rounds = 100, warm_up = 10;
};

/// The cost of the rounds, without the warm-up; CPU times of all threads.
struct BenchClientFigures {
  double wall_s = 0;
  double server_cpu_s = 0, client_cpu_s = 0;
  std::string hash;  // of the state at the end
};

/// Drives the robots of `daemon`, in the same way for every client. Throws std::runtime_error with the
/// client's output.
BenchClientFigures DriveBench(const BenchDaemon& daemon, const BenchClientOptions& options);

}  // namespace coopdyn
