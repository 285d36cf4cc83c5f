// SPDX-License-Identifier: MIT
// The daemon that `coopdyn bench lockstep` measures: this program as a child process on free ports, with a
// scenario of its own. One thread.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct BenchDaemonOptions {
  int robots = 100;
  std::string robot = "minibot";
  std::string fidelity = "rolling";
  std::optional<int> rays = std::nullopt;  // single rays all round instead of the robot's sensors
  double range_m = 4;                      // of those
  std::optional<int> robot_threads = std::nullopt;
  int threads = 1;
  std::string record;  // what of the run is recorded, as --record-what; empty: nothing
};

class BenchDaemon {
 public:
  /// Starts `coopdyn serve` in lockstep; the robots, bot1, bot2, …, stand at seeded places, one to the square
  /// metre, between walls. Returns when it is ready. Throws std::runtime_error with what the daemon said.
  explicit BenchDaemon(const BenchDaemonOptions& options);
  /// Ends the daemon and removes its files.
  ~BenchDaemon();
  BenchDaemon(const BenchDaemon&) = delete;
  BenchDaemon& operator=(const BenchDaemon&) = delete;

  /// "127.0.0.1:PORT"
  const std::string& address() const { return address_; }
  pid_t pid() const { return pid_; }

 private:
  void Start(const BenchDaemonOptions& options);
  void End();

  std::string folder_;  // of its own
  std::string address_;
  pid_t pid_ = 0;
};

/// CPU time that all threads of a process have had, s.
double CpuOf(pid_t pid);

}  // namespace coopdyn
