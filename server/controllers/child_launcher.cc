// SPDX-License-Identifier: MIT
#include "server/controllers/child_launcher.h"

#include <fcntl.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

extern char** environ;

namespace coopdyn {

namespace {

constexpr int kSocketFile = 3;  // that the template gets

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
      return "was killed (by somebody, or by the system for its memory)";
    default: {
      const char* name = sigabbrev_np(signal);
      return name == nullptr ? fmt::format("was ended by signal {}", signal)
                             : fmt::format("was ended by signal SIG{}", name);
    }
  }
}

namespace {

ChildEnd EndOf(int status, double cpu_s) {
  ChildEnd end;
  end.cpu_s = cpu_s;
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  return end;
}

}  // namespace

ChildLauncher::~ChildLauncher() {
  EndTemplate();
}

void ChildLauncher::StartTemplate() {
  if (std::getenv(kMark) != nullptr) Check(EPERM, "a controllers' process may not start another");
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0) Check(errno, "socketpair");
  try {
    const Lifted theirs(sockets[1]);
    FileActions files;
    Check(posix_spawn_file_actions_addopen(&files.raw, STDIN_FILENO, "/dev/null", O_RDONLY, 0),
          "posix_spawn");
    // Our stdout belongs to the one line `ready ...`.
    Check(posix_spawn_file_actions_adddup2(&files.raw, STDERR_FILENO, STDOUT_FILENO), "posix_spawn");
    Check(posix_spawn_file_actions_adddup2(&files.raw, theirs.fd(), kSocketFile), "posix_spawn");
    Check(posix_spawn_file_actions_addclosefrom_np(&files.raw, kSocketFile + 1), "posix_spawn");

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

    std::vector<std::string> arguments = {program_, "controller-child", std::to_string(kSocketFile)};
    std::vector<std::string> environment = Environment();
    Check(posix_spawn(&template_, program_.c_str(), &files.raw, &attributes.raw, Pointers(arguments).data(),
                      Pointers(environment).data()),
          program_.c_str());
  } catch (...) {
    close(sockets[0]);
    close(sockets[1]);
    throw;
  }
  close(sockets[1]);
  socket_ = sockets[0];
}

ChildEnd ChildLauncher::EndTemplate() {
  if (template_ < 0) return {};
  int status = 0;
  kill(template_, SIGKILL);
  while (waitpid(template_, &status, 0) < 0 && errno == EINTR) {
  }
  close(socket_);
  template_ = socket_ = -1;
  return EndOf(status, 0);
}

bool ChildLauncher::Send(const LaunchRequest& request, const std::array<int, 3>* files) const {
  LaunchRequest sent = request;
  iovec bytes{&sent, sizeof(sent)};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(*files))> room{};
  if (files != nullptr) {
    message.msg_control = room.data();
    message.msg_controllen = room.size();
    cmsghdr* header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(*files));
    std::memcpy(CMSG_DATA(header), files->data(), sizeof(*files));
  }
  ssize_t done = 0;
  do {
    done = sendmsg(socket_, &message, MSG_NOSIGNAL);
  } while (done < 0 && errno == EINTR);
  return done == sizeof(sent);
}

bool ChildLauncher::Ask(const LaunchRequest& request, const std::array<int, 3>* files,
                        LaunchReply& reply) const {
  if (!Send(request, files)) return false;
  ssize_t done = 0;
  do {
    done = recv(socket_, &reply, sizeof(reply), 0);
  } while (done < 0 && errno == EINTR);
  return done == sizeof(reply);
}

pid_t ChildLauncher::Launch(const std::array<int, 3>& files) {
  LaunchReply reply;
  ChildEnd end;
  // Somebody may have killed the template: once more with a new one.
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (template_ < 0) StartTemplate();
    if (Ask({LaunchRequest::Kind::kStart, 0}, &files, reply)) {
      if (reply.pid < 0) Check(reply.error, "fork");
      return reply.pid;
    }
    end = EndTemplate();
  }
  throw std::runtime_error(program_ + " " + end.ToString());
}

ChildEnd ChildLauncher::AwaitEnd(pid_t pid) {
  LaunchReply reply;
  const bool told =
      template_ >= 0 && Ask({LaunchRequest::Kind::kAwaitEnd, pid}, nullptr, reply) && reply.pid == pid;
  if (!told) return EndOf(SIGKILL, 0);  // as the template, probably
  ChildEnd end = EndOf(reply.status, reply.cpu_s);
  end.memory_bytes = reply.memory_bytes;
  return end;
}

void ChildLauncher::Leave(pid_t pid) {
  if (template_ >= 0) Send({LaunchRequest::Kind::kLeave, pid}, nullptr);
}

}  // namespace coopdyn
