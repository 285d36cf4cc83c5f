// SPDX-License-Identifier: MIT
// The client that `coopdyn bench lockstep` measures with: a process of its own that drives all robots, with
// the client library of C++ or Python as a user would.
#pragma once

#include <string>

#include "tests/bench/bench_daemon.h"

namespace coopdyn {

struct BenchClientOptions {
  bool batch = false;   // one team, else one connection per robot
  bool python = false;  // else C++
  int robots = 100;
  bool readings = false;  // distances with every round; a team reads poses always
  bool at_rest = false;   // every command says 0, else the robots wander
  int rounds = 100, warm_up = 10;
};

/// What the rounds took, without the warm-up; CPU times of all threads.
struct BenchClientFigures {
  double wall_s = 0;
  double server_cpu_s = 0, client_cpu_s = 0;
  std::string hash;  // of the state at the end
};

/// Drives the robots of `daemon`, all in the same way whatever the client. Throws std::runtime_error with
/// what the client said.
BenchClientFigures DriveBench(const BenchDaemon& daemon, const BenchClientOptions& options);

}  // namespace coopdyn
