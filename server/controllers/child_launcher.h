// SPDX-License-Identifier: MIT
// Starts controllers' processes quickly. One template process, which never loads a controller, is started as
// `program controller-child 3` and copies itself for each: what the program does before it can begin (some
// 30 ms, of which most is libsdformat's) is done once, not with each reset. The stepping thread only.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>

namespace coopdyn {

/// The exit code of a process in which a controller got no more memory.
inline constexpr int kOutOfMemoryExit = 109;

/// How a process ended.
struct ChildEnd {
  int signal = 0;                  // 0: it exited by itself
  int exit_code = 0;               // then
  double cpu_s = 0;                // that it has used in all
  std::uint64_t memory_bytes = 0;  // the most that it had

  /// The controller in hand may have had nothing to do with it: somebody else killed it.
  bool by_others() const;
  /// E.g. "crashed (segmentation fault)", "called exit(3)".
  std::string ToString() const;
};

/// What the template is asked, and answers; over a SOCK_SEQPACKET socket.
struct LaunchRequest {
  enum class Kind : std::uint32_t { kStart, kAwaitEnd, kLeave };
  Kind kind = Kind::kStart;  // kStart: with the files socket, in, out; kLeave: has no answer
  pid_t pid = 0;             // kAwaitEnd, kLeave: of a copy
};
struct LaunchReply {
  pid_t pid = 0;   // kStart: of the copy; -1: it could not be made
  int error = 0;   // then: errno
  int status = 0;  // kAwaitEnd: as of wait()
  double cpu_s = 0;
  std::uint64_t memory_bytes = 0;
};

class ChildLauncher {
 public:
  /// Starts nothing yet.
  explicit ChildLauncher(std::string program) : program_(std::move(program)) {}
  /// Ends the template; copies go on as long as their socket is open.
  ~ChildLauncher();
  ChildLauncher(const ChildLauncher&) = delete;
  ChildLauncher& operator=(const ChildLauncher&) = delete;

  /// A new process that serves `files`: its socket, the areas `in` and `out`. Its stdin is /dev/null, its
  /// stdout our stderr; it has no other files, and signals as by default. Throws std::exception.
  pid_t Launch(const std::array<int, 3>& files);
  /// Waits for the end of a process that Launch() gave.
  ChildEnd AwaitEnd(pid_t pid);
  /// Nobody will ask how a process that Launch() gave ended.
  void Leave(pid_t pid);

 private:
  void StartTemplate();
  ChildEnd EndTemplate();
  /// False: the template is gone.
  bool Send(const LaunchRequest& request, const std::array<int, 3>* files) const;
  /// False: the template is gone.
  bool Ask(const LaunchRequest& request, const std::array<int, 3>* files, LaunchReply& reply) const;

  const std::string program_;
  pid_t template_ = -1;
  int socket_ = -1;
};

}  // namespace coopdyn
