// SPDX-License-Identifier: MIT
// The process in which controllers run. One owner.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "server/base/clock.h"

namespace coopdyn {

/// How a process ended.
struct ChildEnd {
  int signal = 0;     // 0: it exited by itself
  int exit_code = 0;  // then
  double cpu_s = 0;   // that it has used in all

  /// The controller in hand may have had nothing to do with it: somebody else killed it.
  bool by_others() const;
  /// E.g. "crashed (segmentation fault)", "called exit(3)".
  std::string ToString() const;
};

class ChildProcess {
 public:
  /// Starts `program` as `program controller-child 3`, with a socket, `in_fd` and `out_fd` as its files 3, 4
  /// and 5, /dev/null as its stdin and our stderr as its stdout; all other files are closed, signals as by
  /// default. It ends as soon as this process ends or Close() is called. Throws std::system_error.
  ChildProcess(const std::string& program, int in_fd, int out_fd);
  /// Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  /// If it has ended: how.
  std::optional<ChildEnd> Ended();
  /// Waits for its end, `at_most` so long; false: it still runs.
  bool WaitFor(Nanoseconds at_most);
  /// Waits for its end.
  ChildEnd Wait();
  void Kill();
  /// CPU time that it has used so far, s.
  double cpu_s() const;

 private:
  void Reap(int options);

  pid_t pid_ = -1;
  int socket_ = -1;  // the child ends when its other end is closed
  std::optional<ChildEnd> end_;
};

}  // namespace coopdyn
