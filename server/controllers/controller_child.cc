// SPDX-License-Identifier: MIT
#include "server/controllers/controller_child.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/controllers/child_launcher.h"
#include "server/controllers/futex.h"
#include "server/controllers/runner.h"
#include "server/controllers/shared_area.h"

namespace coopdyn {

namespace {

/// Ends the process when the other end of `socket` is closed, whatever the controllers are doing: the daemon
/// is gone. (PR_SET_PDEATHSIG would act at the end of the thread that started us.) `socket` shut down on our
/// side ends only the wait.
class ParentWatch {
 public:
  explicit ParentWatch(int socket) : socket_(socket), thread_([this] { Watch(); }) {}
  ~ParentWatch() {
    ending_ = true;
    shutdown(socket_, SHUT_RDWR);
  }
  ParentWatch(const ParentWatch&) = delete;
  ParentWatch& operator=(const ParentWatch&) = delete;

 private:
  void Watch() {
    pollfd hangup{socket_, POLLRDHUP, 0};
    while (poll(&hangup, 1, -1) < 0 && errno == EINTR) {
    }
    if (!ending_) _exit(0);
  }

  const int socket_;
  std::atomic<bool> ending_{false};
  std::jthread thread_;  // last: joined first
};

/// Crashes are reported by the daemon; a core file for each would fill the disk.
void NoCoreFiles() {
  // Not 0: a core_pattern that is a pipe ignores every limit but 1.
  rlimit limit{};
  if (getrlimit(RLIMIT_CORE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max < 1 ? limit.rlim_max : 1;
  setrlimit(RLIMIT_CORE, &limit);
}

/// What a batch system or a terminal sends to all processes at once is for the daemon, which ends us in
/// order. Programs that a controller starts are signalled as usual.
void LeaveSignalsToDaemon() {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) std::signal(signal, [](int) {});
}

/// The files that a copy serves: its socket and the areas.
struct Files {
  int socket = -1, in = -1, out = -1;
};

/// Other areas, from the daemon: the files that come with the next byte.
void TakeAreas(Files& files) {
  std::array<int, 2> areas{-1, -1};
  char byte = 0;
  iovec bytes{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(areas))> room{};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  ssize_t got = 0;
  do {
    got = recvmsg(files.socket, &message, MSG_CMSG_CLOEXEC);
  } while (got < 0 && errno == EINTR);
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (got != 1 || header == nullptr || header->cmsg_type != SCM_RIGHTS ||
      header->cmsg_len != CMSG_LEN(sizeof(areas))) {
    throw std::runtime_error("the daemon sent no areas");
  }
  std::memcpy(areas.data(), CMSG_DATA(header), sizeof(areas));
  close(files.in);
  close(files.out);
  files.in = areas[0];
  files.out = areas[1];
}

/// Controllers get no more than `bytes` of memory beyond what the process has now, and the system ends this
/// process rather than another when it has none left itself.
void LimitMemory([[maybe_unused]] std::uint64_t bytes) {
  if (std::FILE* file = std::fopen("/proc/self/oom_score_adj", "w"); file != nullptr) {
    std::fputs("1000", file);
    std::fclose(file);
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they map terabytes
  if (bytes == 0) return;
  unsigned long data_pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r"); file != nullptr) {
    if (std::fscanf(file, "%*u %*u %*u %*u %*u %lu", &data_pages) != 1) data_pages = 0;
    std::fclose(file);
  }
  const std::uint64_t limit = bytes + data_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const rlimit both{limit, limit};
  setrlimit(RLIMIT_DATA, &both);
#endif
}

[[noreturn]] void Serve(Files files) {
  const ParentWatch watch(files.socket);
  SharedArea in(files.in, false), out(files.out, true);
  auto runner = std::make_unique<Runner>();
  std::unique_ptr<WorkerPool> pool;
  for (std::uint32_t seen = 0;;) {
    const InHeader& header = *in.At<InHeader>(0);
    while (header.go.load(std::memory_order_acquire) == seen) FutexWait(header.go, seen, 0);
    const std::uint32_t go = header.go.load(std::memory_order_acquire);
    if (header.operation == Operation::kMove) {
      TakeAreas(files);
      in = SharedArea(files.in, false);
      out = SharedArea(files.out, true);
      continue;  // the next operation may be there already
    }
    seen = go;
    if (!pool) {
      pool = std::make_unique<WorkerPool>(static_cast<int>(header.workers));
      LimitMemory(header.memory_bytes);
      Runner::EndWithoutMemory();
    }
    const bool last = header.operation == Operation::kEnd;
    runner->Run(in.data(), out.data(), *pool);
    if (last) {
      // Unloads the controllers. After the answer the next ones may begin, and this process is not waited
      // for.
      runner.reset();
      std::fflush(nullptr);
    }
    std::atomic<std::uint32_t>& reply = out.At<OutHeader>(0)->reply;
    reply.store(seen, std::memory_order_release);
    FutexWake(reply);
    // Not by way of our own static objects: that takes longer than a new process does to begin.
    if (last) _exit(0);
  }
}

/// The main program of a copy.
int RunCopy(const Files& files) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGCHLD, SIG_DFL);
  setpgid(0, 0);  // what a controller does to its process group is its own
  // A copy that a controller makes of this process would go on as if it were the process itself.
  pthread_atfork(nullptr, nullptr, [] { _exit(0); });
  prctl(PR_SET_NAME, "coopdyn-ctrl");
  try {
    Serve(files);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "coopdyn: the controllers' process: %s\n", exception.what());
    return 1;
  }
}

/// Copies that the daemon does not ask for any more.
class LeftCopies {
 public:
  /// Lets the end of a copy interrupt AwaitRequest(), and nothing else.
  LeftCopies() {
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGCHLD);
    sigprocmask(SIG_BLOCK, &ends, &before_);
    struct sigaction action {};
    action.sa_handler = [](int) {};
    sigaction(SIGCHLD, &action, nullptr);
  }
  void Add(pid_t pid) { pids_.push_back(pid); }
  /// Until there is something to read; lets go of those that have ended.
  void AwaitRequest(int socket) {
    pollfd request{socket, POLLIN, 0};
    do {
      std::erase_if(pids_, [](pid_t pid) { return waitpid(pid, nullptr, WNOHANG) != 0; });
    } while (ppoll(&request, 1, nullptr, &before_) < 0 && errno == EINTR);
  }

 private:
  sigset_t before_{};
  std::vector<pid_t> pids_;
};

/// The next request with its files, if it has any. False: the daemon is gone.
bool Receive(int socket, LeftCopies& left, LaunchRequest& request, Files& files) {
  iovec bytes{&request, sizeof(request)};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(files))> room{};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  ssize_t got = 0;
  left.AwaitRequest(socket);
  do {
    got = recvmsg(socket, &message, 0);
  } while (got < 0 && errno == EINTR);
  if (got != sizeof(request)) return false;
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_type == SCM_RIGHTS && header->cmsg_len == CMSG_LEN(sizeof(files))) {
    std::memcpy(&files, CMSG_DATA(header), sizeof(files));
  }
  return true;
}

LaunchReply AwaitEnd(pid_t pid) {
  LaunchReply reply;
  rusage usage{};
  do {
    reply.pid = wait4(pid, &reply.status, 0, &usage);
  } while (reply.pid < 0 && errno == EINTR);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  reply.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  reply.memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
  return reply;
}

}  // namespace

int RunControllerChild(int fd) {
  int type = 0;
  socklen_t size = sizeof(type);
  if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_SEQPACKET) {
    std::fputs("coopdyn: controller-child is started by coopdyn serve itself; write coopdyn serve SCENARIO\n",
               stderr);
    return 2;
  }
  NoCoreFiles();
  LeaveSignalsToDaemon();
  prctl(PR_SET_NAME, "coopdyn-ctrl-0");
  LeftCopies left;
  LaunchRequest request;
  for (Files files; Receive(fd, left, request, files); files = {}) {
    if (request.kind == LaunchRequest::Kind::kLeave) {
      left.Add(request.pid);
      continue;
    }
    LaunchReply reply;
    if (request.kind == LaunchRequest::Kind::kAwaitEnd) {
      reply = AwaitEnd(request.pid);
    } else {
      reply.pid = fork();
      reply.error = errno;
      if (reply.pid == 0) {
        close(fd);
        return RunCopy(files);
      }
    }
    for (const int file : {files.socket, files.in, files.out}) {
      if (file >= 0) close(file);
    }
    if (send(fd, &reply, sizeof(reply), MSG_NOSIGNAL) != sizeof(reply)) break;
  }
  return 0;
}

}  // namespace coopdyn
