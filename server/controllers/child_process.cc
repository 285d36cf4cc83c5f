// SPDX-License-Identifier: MIT
#include "server/controllers/child_process.h"
#include "server/base/sanitizers.h"

#include <fcntl.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace coopdyn {

namespace {

constexpr int kSocketFile = 3;  // file descriptor of the template's socket

// Set for the child. Without it, a program that misinterprets `controller-child` and starts another host
// would start children endlessly.
constexpr const char* kMark = "COOPDYN_CONTROLLER_CHILD";

[[noreturn]] void Fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// The environment with the mark first. Sanitizers, if built in, are told not to handle crashes.
std::vector<std::string> Environment() {
  std::vector<std::string> variables = {std::string(kMark) + "=1"};
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  const auto add = [&variables](const char* name, const char* more) {
    const char* set = std::getenv(name);
    variables.push_back(fmt::format(
        "{}={}:handle_segv=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0:handle_abort=0:detect_leaks=0{}",
        name, set == nullptr ? "" : set, more));
  };
  add("ASAN_OPTIONS", "");
  add("TSAN_OPTIONS", ":atexit_sleep_ms=0");  // else exit() takes as long as the deadline
#endif
  // If a name occurs twice, the first counts.
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
  return variables;
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Turns a fork of the daemon into the template.
[[noreturn]] void BecomeTemplate(int socket, char* const* arguments, char* const* environment) {
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);  // Ctrl-C in the terminal goes only to the daemon, which ends its children in order
  dup2(socket, kSocketFile);
  fcntl(kSocketFile, F_SETFD, 0);  // in case the socket already had this number
  dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);  // the daemon's stdout is for the line `ready ...`
  close_range(kSocketFile + 1, ~0u, 0);
  execve(arguments[0], arguments, environment);
  _exit(127);
}

/// Requests a copy that serves these files from the template. False if the template has ended.
bool SendFiles(int socket, const std::array<int, 2>& files) {
  char byte = 0;
  iovec bytes{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(files))> room{};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof(files));
  std::memcpy(CMSG_DATA(header), files.data(), sizeof(files));
  return TEMP_FAILURE_RETRY(sendmsg(socket, &message, MSG_NOSIGNAL)) == 1;
}

}  // namespace

ChildEnd ChildEnd::Of(int status) {
  ChildEnd end;
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  return end;
}

bool ChildEnd::by_others() const {
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGQUIT;
}

std::string ChildEnd::ToString() const {
  switch (signal) {
    case 0:
      return fmt::format("called exit({})", exit_code);
    case SIGSEGV:
      return "crashed (segmentation fault: it used memory that is not its own, or recursed without end)";
    case SIGBUS:
      return "crashed (bus error)";
    case SIGFPE:
      return "crashed (integer division by zero)";
    case SIGILL:
      return "crashed (illegal instruction)";
    case SIGABRT:
      return "crashed (abort)";
    case SIGKILL:
      return "was killed (by somebody, or by the system because memory ran out)";
    default: {
      const char* name = sigabbrev_np(signal);
      return "was ended by signal " + (name == nullptr ? std::to_string(signal) : std::string("SIG") + name);
    }
  }
}

void ChildLauncher::StartTemplate() {
  if (std::getenv(kMark) != nullptr) Fail(EPERM, "a controllers' process may not start another");
  if (access(program_.c_str(), X_OK) != 0) Fail(errno, program_);
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0) Fail(errno, "socketpair");
  std::vector<std::string> arguments = {program_, "controller-child", std::to_string(kSocketFile)};
  std::vector<std::string> environment = Environment();
  const std::vector<char*> argv = Pointers(arguments), envp = Pointers(environment);
  template_ = fork();
  if (template_ == 0) BecomeTemplate(sockets[1], argv.data(), envp.data());
  const int error = errno;
  close(sockets[1]);
  socket_ = sockets[0];
  if (template_ > 0) return;
  close(socket_);
  Fail(error, "fork");
}

ChildEnd ChildLauncher::EndTemplate() {
  if (template_ < 0) return {};
  int status = 0;
  kill(template_, SIGKILL);
  TEMP_FAILURE_RETRY(waitpid(template_, &status, 0));
  close(socket_);
  template_ = socket_ = -1;
  return ChildEnd::Of(status);
}

std::optional<CopyReport> ChildLauncher::Receive() {
  CopyReport report;
  if (TEMP_FAILURE_RETRY(recv(socket_, &report, sizeof(report), 0)) != sizeof(report)) return std::nullopt;
  const auto copy = copies_.find(report.pid);
  if (report.ended && copy != copies_.end()) copy->second = report.end;
  return report;
}

pid_t ChildLauncher::Launch(int in_fd, int out_fd) {
  ChildEnd end;
  // If the template was killed, try once more with a new one.
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (template_ < 0) StartTemplate();
    if (SendFiles(socket_, {in_fd, out_fd})) {
      while (const std::optional<CopyReport> report = Receive()) {
        if (report->ended) continue;
        if (report->pid < 0) Fail(report->error, "fork");
        copies_[report->pid].reset();
        return report->pid;
      }
    }
    end = EndTemplate();
  }
  throw std::runtime_error(program_ + " " + end.ToString());
}

ChildEnd ChildLauncher::AwaitEnd(pid_t pid) {
  std::optional<ChildEnd>& end = copies_[pid];
  while (!end && template_ >= 0 && Receive()) {
  }
  const ChildEnd known = end.value_or(ChildEnd::Of(SIGKILL));  // killed with its template
  Forget(pid);
  return known;
}

ChildProcess::ChildProcess(ChildLauncher& launcher, int in_fd, int out_fd)
    : launcher_(launcher), pid_(launcher.Launch(in_fd, out_fd)) {
  watched_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (watched_ >= 0) return;
  const int error = errno;
  kill(pid_, SIGKILL);
  launcher_.AwaitEnd(pid_);
  Fail(error, "pidfd_open");
}

ChildProcess::~ChildProcess() {
  if (pid_ >= 0) End();
  close(watched_);
}

bool ChildProcess::ended() const {
  pollfd poll_for{watched_, POLLIN, 0};
  return poll(&poll_for, 1, 0) == 1;
}

ChildEnd ChildProcess::End() {
  // Do not use the pid: once the template has ended, another process may have it.
  syscall(SYS_pidfd_send_signal, watched_, SIGKILL, nullptr, 0);
  return launcher_.AwaitEnd(std::exchange(pid_, -1));
}

void ChildProcess::Leave() {
  launcher_.Forget(std::exchange(pid_, -1));
}

double ChildProcess::cpu_s() const {
  clockid_t clock = 0;
  timespec time{};
  if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace coopdyn
