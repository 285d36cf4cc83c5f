// SPDX-License-Identifier: MIT
// The process in which controllers run. One owner, the stepping thread.
#pragma once

#include <sys/types.h>

#include <optional>

#include "server/base/clock.h"
#include "server/controllers/child_launcher.h"

namespace coopdyn {

class ChildProcess {
 public:
  /// Starts it on the areas `in_fd` and `out_fd`. It ends as soon as this process ends or closes its end of
  /// their socket. The launcher outlives it. Throws std::exception.
  ChildProcess(ChildLauncher& launcher, int in_fd, int out_fd);
  /// Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Hands it other areas, which it takes when it is told to. False: it takes nothing any more.
  bool HandOver(int in_fd, int out_fd);

  pid_t pid() const { return pid_; }
  /// If it has ended: how.
  std::optional<ChildEnd> Ended();
  /// Waits for its end, `at_most` so long; false: it still runs.
  bool WaitFor(Nanoseconds at_most);
  /// Waits for its end.
  ChildEnd Wait();
  void Kill();
  /// It is about to end by itself, and nobody need wait for that.
  void Leave();
  /// CPU time that it has used so far, s.
  double cpu_s() const;

 private:
  ChildLauncher& launcher_;
  pid_t pid_ = -1;
  int socket_ = -1;   // the child ends when its other end is closed
  int watched_ = -1;  // readable when it has ended
  std::optional<ChildEnd> end_;
};

}  // namespace coopdyn
