// SPDX-License-Identifier: MIT
#include "server/controllers/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <system_error>
#include <vector>

extern char** environ;

namespace coopdyn {

namespace {

constexpr int kFirstFile = 3;  // of the three that the child gets

void Check(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

/// A copy of `fd` that is out of the way of the numbers which the child's files get.
class Lifted {
 public:
  explicit Lifted(int fd) : fd_(fcntl(fd, F_DUPFD_CLOEXEC, 16)) {
    if (fd_ < 0) Check(errno, "fcntl");
  }
  ~Lifted() { close(fd_); }
  Lifted(const Lifted&) = delete;
  Lifted& operator=(const Lifted&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

struct FileActions {
  posix_spawn_file_actions_t raw;
  FileActions() { Check(posix_spawn_file_actions_init(&raw), "posix_spawn_file_actions_init"); }
  ~FileActions() { posix_spawn_file_actions_destroy(&raw); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
};

struct Attributes {
  posix_spawnattr_t raw;
  Attributes() { Check(posix_spawnattr_init(&raw), "posix_spawnattr_init"); }
  ~Attributes() { posix_spawnattr_destroy(&raw); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
};

// Set for the child. A program that takes `controller-child` for something else and starts all over again
// would otherwise start children without end.
constexpr const char* kMark = "COOPDYN_CONTROLLER_CHILD";

/// The environment, with the mark; where a sanitizer is built in, told to leave crashes to us.
std::vector<std::string> Environment() {
  std::vector<std::string> variables;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr const char* kLeave =
      "handle_segv=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0:handle_abort=0:detect_leaks=0";
  constexpr const char* kAtOnce = ":atexit_sleep_ms=0";  // exit() would take as long as the deadline
  bool asan = false, tsan = false;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    std::string text = *variable;
    const bool is_asan = text.starts_with("ASAN_OPTIONS="), is_tsan = text.starts_with("TSAN_OPTIONS=");
    if (is_asan || is_tsan) text += std::string(":") + kLeave;
    if (is_tsan) text += kAtOnce;
    asan |= is_asan;
    tsan |= is_tsan;
    variables.push_back(std::move(text));
  }
  if (!asan) variables.push_back(std::string("ASAN_OPTIONS=") + kLeave);
  if (!tsan) variables.push_back(std::string("TSAN_OPTIONS=") + kLeave + kAtOnce);
#else
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
#endif
  variables.push_back(std::string(kMark) + "=1");
  return variables;
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

bool ChildEnd::by_others() const {
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGQUIT;
}

std::string ChildEnd::ToString() const {
  switch (signal) {
    case 0:
      return fmt::format("called exit({})", exit_code);
    case SIGSEGV:
      return "crashed (segmentation fault: memory that is not its own, or endless recursion)";
    case SIGBUS:
      return "crashed (bus error)";
    case SIGFPE:
      return "crashed (integer division by zero)";
    case SIGILL:
      return "crashed (illegal instruction)";
    case SIGABRT:
      return "crashed (abort)";
    case SIGKILL:
      return "was killed (too much memory?)";
    default: {
      const char* name = sigabbrev_np(signal);
      return name == nullptr ? fmt::format("was ended by signal {}", signal)
                             : fmt::format("was ended by signal SIG{}", name);
    }
  }
}

ChildProcess::ChildProcess(const std::string& program, int in_fd, int out_fd) {
  if (std::getenv(kMark) != nullptr) Check(EPERM, "a controllers' process may not start another");
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) Check(errno, "socketpair");
  socket_ = sockets[0];
  try {
    const Lifted theirs(sockets[1]), in(in_fd), out(out_fd);
    FileActions files;
    Check(posix_spawn_file_actions_addopen(&files.raw, STDIN_FILENO, "/dev/null", O_RDONLY, 0),
          "posix_spawn");
    // Our stdout belongs to the one line `ready ...`.
    Check(posix_spawn_file_actions_adddup2(&files.raw, STDERR_FILENO, STDOUT_FILENO), "posix_spawn");
    Check(posix_spawn_file_actions_adddup2(&files.raw, theirs.fd(), kFirstFile), "posix_spawn");
    Check(posix_spawn_file_actions_adddup2(&files.raw, in.fd(), kFirstFile + 1), "posix_spawn");
    Check(posix_spawn_file_actions_adddup2(&files.raw, out.fd(), kFirstFile + 2), "posix_spawn");
    Check(posix_spawn_file_actions_addclosefrom_np(&files.raw, kFirstFile + 3), "posix_spawn");

    Attributes attributes;
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    Check(posix_spawnattr_setsigdefault(&attributes.raw, &all), "posix_spawn");
    Check(posix_spawnattr_setsigmask(&attributes.raw, &none), "posix_spawn");
    // A process group of its own: the terminal's Ctrl-C is for the daemon, which ends it in order.
    Check(posix_spawnattr_setpgroup(&attributes.raw, 0), "posix_spawn");
    Check(posix_spawnattr_setflags(&attributes.raw,
                                   POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP),
          "posix_spawn");

    std::vector<std::string> arguments = {program, "controller-child", std::to_string(kFirstFile)};
    std::vector<std::string> environment = Environment();
    Check(posix_spawn(&pid_, program.c_str(), &files.raw, &attributes.raw, Pointers(arguments).data(),
                      Pointers(environment).data()),
          program.c_str());
  } catch (...) {
    close(sockets[0]);
    close(sockets[1]);
    throw;
  }
  close(sockets[1]);
}

ChildProcess::~ChildProcess() {
  if (!end_) {
    Kill();
    Wait();
  }
  close(socket_);
}

std::optional<ChildEnd> ChildProcess::Ended() {
  if (!end_) Reap(WNOHANG);
  return end_;
}

bool ChildProcess::WaitFor(Nanoseconds at_most) {
  const int watched = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (watched < 0) return Ended().has_value();
  pollfd poll_for{watched, POLLIN, 0};
  poll(&poll_for, 1, static_cast<int>(at_most / 1'000'000));
  close(watched);
  return Ended().has_value();
}

ChildEnd ChildProcess::Wait() {
  if (!end_) Reap(0);
  return *end_;
}

void ChildProcess::Kill() {
  if (!end_) kill(pid_, SIGKILL);
}

double ChildProcess::cpu_s() const {
  if (end_) return end_->cpu_s;
  clockid_t clock = 0;
  timespec time{};
  if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void ChildProcess::Reap(int options) {
  int status = 0;
  rusage usage{};
  pid_t reaped = 0;
  do {
    reaped = wait4(pid_, &status, options, &usage);
  } while (reaped < 0 && errno == EINTR);
  if (reaped == 0) return;
  ChildEnd end;
  if (reaped == pid_) {
    if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
    if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
    end.cpu_s = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  }
  end_ = end;
}

}  // namespace coopdyn
