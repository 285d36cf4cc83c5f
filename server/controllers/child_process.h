// SPDX-License-Identifier: MIT
// The process in which controllers run. A template process, which never loads a controller, is started once
// as `program controller-child 3` and forks a copy for each set of controllers. A reset therefore does not
// wait for the program to start (some 30 ms, mostly for libsdformat). The template and its copies end with
// the daemon. Used only by the stepping thread.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace coopdyn {

/// The exit code of a process in which a controller ran out of memory.
inline constexpr int kOutOfMemoryExit = 109;

/// How a process ended.
struct ChildEnd {
  int signal = 0;                  // 0: it called exit()
  int exit_code = 0;               // if signal is 0
  double cpu_s = 0;                // total used
  std::uint64_t memory_bytes = 0;  // peak resident size

  static ChildEnd Of(int status);
  /// Another program may have killed the process: the running controller is perhaps not to blame.
  bool by_others() const;
  /// E.g. "crashed (segmentation fault)", "called exit(3)".
  std::string ToString() const;
};

/// The template's message over a SOCK_SEQPACKET socket when a copy has started or ended. The daemon requests
/// a copy with a message that carries the file descriptors of the areas `in` and `out`.
struct CopyReport {
  pid_t pid = -1;  // -1: the copy could not be started
  int error = 0;   // if pid is -1: errno
  bool ended = false;
  ChildEnd end;
};

/// The main program of the template: `coopdyn controller-child FD`. Returns in the template and in copies,
/// with the exit code of that process.
int RunControllerChild(int fd);

class ChildLauncher {
 public:
  /// Starts nothing yet.
  explicit ChildLauncher(std::string program) : program_(std::move(program)) {}
  /// Kills the template and all copies.
  ~ChildLauncher() { EndTemplate(); }
  ChildLauncher(const ChildLauncher&) = delete;
  ChildLauncher& operator=(const ChildLauncher&) = delete;

  /// Starts a process that serves these areas. Its stdin is /dev/null and its stdout is this process's
  /// stderr; it has no other files and default signal actions. Throws std::exception.
  pid_t Launch(int in_fd, int out_fd);
  /// Waits for the end of a process that Launch() returned.
  ChildEnd AwaitEnd(pid_t pid);
  /// Drops the record of a process: its end will not be queried.
  void Forget(pid_t pid) { copies_.erase(pid); }

 private:
  void StartTemplate();
  ChildEnd EndTemplate();
  /// Receives the next report and notes an end in `copies_`. Nullopt if the template has ended.
  std::optional<CopyReport> Receive();

  const std::string program_;
  pid_t template_ = -1;
  int socket_ = -1;
  std::map<pid_t, std::optional<ChildEnd>> copies_;  // copies in use; set once ended
};

class ChildProcess {
 public:
  /// Starts the process. `launcher` must outlive it. Throws std::exception.
  ChildProcess(ChildLauncher& launcher, int in_fd, int out_fd);
  /// Kills the process if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  bool ended() const;
  /// Kills the process if it still runs. Returns how it ended.
  ChildEnd End();
  /// Releases the process, which is about to exit: the destructor does not wait for it.
  void Leave();
  /// CPU time used so far, s.
  double cpu_s() const;

 private:
  ChildLauncher& launcher_;
  pid_t pid_ = -1;    // -1 after End() or Leave()
  int watched_ = -1;  // pidfd: readable once the process has ended
};

}  // namespace coopdyn
