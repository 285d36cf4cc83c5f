// SPDX-License-Identifier: MIT
// The real daemon as a child process on free ports, for the benchmarks. One thread.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

namespace coopdyn {

struct BenchDaemonOptions {
  /// Texts by name, put into the daemon's folder, where it finds robots too. It serves bench.scenario.
  std::map<std::string, std::string> files;
  std::vector<std::string> words = {};  // further options of `coopdyn serve`
  std::string record = {};              // what of the run is recorded, as --record-what; empty: nothing
  std::string program = {};             // empty: the coopdyn beside this program
};

class BenchDaemon {
 public:
  /// Starts `coopdyn serve`. Returns when it is ready. Throws std::runtime_error with what the daemon said.
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

/// The path of the program `name` in the folder of this one.
std::string ProgramBeside(const std::string& name);

}  // namespace coopdyn
