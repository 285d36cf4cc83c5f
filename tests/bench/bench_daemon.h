// SPDX-License-Identifier: MIT
// The real daemon as a child process on free ports, for the benchmarks. One thread.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

namespace coopdyn {

struct BenchDaemonOptions {
  /// Texts by name, written to the daemon's folder, where it also finds robots. It serves bench.scenario.
  std::map<std::string, std::string> files;
  std::vector<std::string> words = {};  // further options of `coopdyn serve`
  std::string record = {};              // value of --record-what; empty: no recording
  std::string program = {};             // empty: the coopdyn beside this program
};

class BenchDaemon {
 public:
  /// Starts `coopdyn serve`, and returns when it is ready. Throws std::runtime_error with the daemon's
  /// output.
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

  std::string folder_;  // private
  std::string address_;
  pid_t pid_ = 0;
};

/// The path of the program `name` in this program's folder.
std::string ProgramBeside(const std::string& name);

}  // namespace coopdyn
