// SPDX-License-Identifier: MIT
// The process in which controllers run. A template process, which never loads a controller, is started once
// as `program controller-child 3` and forks a copy for each set of controllers. So a reset does not wait for
// the program's start (some 30 ms, most of them libsdformat's). The template ends when the daemon does, and
// its copies with it. The stepping thread only.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace coopdyn {

/// The exit code of a process in which a controller got no more memory.
inline constexpr int kOutOfMemoryExit = 109;

/// How a process ended.
struct ChildEnd {
  int signal = 0;                  // 0: it exited by itself
  int exit_code = 0;               // then
  double cpu_s = 0;                // that it used in all
  std::uint64_t memory_bytes = 0;  // the most that it had

  static ChildEnd Of(int status);
  /// Somebody else killed it: the controller at work need not have had a part in it.
  bool by_others() const;
  /// E.g. "crashed (segmentation fault)", "called exit(3)".
  std::string ToString() const;
};

/// What the template says, over a SOCK_SEQPACKET socket, when a copy has started (it is asked to by a message
/// with the files of the areas `in` and `out`) and when one has ended.
struct CopyReport {
  pid_t pid = -1;  // -1: it could not be started
  int error = 0;   // then: errno
  bool ended = false;
  ChildEnd end;
};

/// The main program of the template: `coopdyn controller-child FD`. Returns the exit code of the template or
/// of a copy, whichever process returns.
int RunControllerChild(int fd);

class ChildLauncher {
 public:
  /// Starts nothing yet.
  explicit ChildLauncher(std::string program) : program_(std::move(program)) {}
  /// Ends the template and all copies.
  ~ChildLauncher() { EndTemplate(); }
  ChildLauncher(const ChildLauncher&) = delete;
  ChildLauncher& operator=(const ChildLauncher&) = delete;

  /// A new process that serves these areas. Its stdin is /dev/null and its stdout our stderr; it has no other
  /// files, and the default action for signals. Throws std::exception.
  pid_t Launch(int in_fd, int out_fd);
  /// Waits for the end of a process that Launch() gave.
  ChildEnd AwaitEnd(pid_t pid);
  /// Nobody will ask how this process ended.
  void Forget(pid_t pid) { copies_.erase(pid); }

 private:
  void StartTemplate();
  ChildEnd EndTemplate();
  /// The next report; an end is noted in `copies_`. Nothing: the template is gone.
  std::optional<CopyReport> Receive();

  const std::string program_;
  pid_t template_ = -1;
  int socket_ = -1;
  std::map<pid_t, std::optional<ChildEnd>> copies_;  // those in use, and how they ended
};

class ChildProcess {
 public:
  /// Starts it. The launcher outlives it. Throws std::exception.
  ChildProcess(ChildLauncher& launcher, int in_fd, int out_fd);
  /// Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  bool ended() const;
  /// Kills it if it still runs. How it ended.
  ChildEnd End();
  /// It is about to end by itself; nobody need wait for that.
  void Leave();
  /// CPU time that it has used so far, s.
  double cpu_s() const;

 private:
  ChildLauncher& launcher_;
  pid_t pid_ = -1;    // -1: it has ended or was left
  int watched_ = -1;  // readable when it has ended
};

}  // namespace coopdyn
