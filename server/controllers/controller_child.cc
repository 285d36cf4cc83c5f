// SPDX-License-Identifier: MIT
// The template process and its copies, which run controllers.
#include <poll.h>
#include <pthread.h>
#include <sched.h>
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

#include "server/base/sanitizers.h"
#include "server/controllers/child_process.h"
#include "server/controllers/runner.h"
#include "server/controllers/shared_area.h"

namespace coopdyn {

namespace {

/// Disables core files: the daemon reports crashes, and a core file for each would fill the disk.
void NoCoreFiles() {
  // Not 0: a core_pattern that is a pipe ignores every limit but 1.
  rlimit limit{};
  if (getrlimit(RLIMIT_CORE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max < 1 ? limit.rlim_max : 1;
  setrlimit(RLIMIT_CORE, &limit);
}

/// Limits the memory of controllers to `bytes` beyond the process's current memory. If the system runs out of
/// memory, it kills this process first.
void LimitMemory([[maybe_unused]] std::uint64_t bytes) {
  if (std::FILE* file = std::fopen("/proc/self/oom_score_adj", "w"); file != nullptr) {
    std::fputs("1000", file);
    std::fclose(file);
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers map terabytes
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

/// File descriptors of the areas `in` and `out`.
using Files = std::array<int, 2>;

/// Waits until the daemon has sent an operation with another number than `seen`.
void AwaitOrder(const Areas& areas, std::uint32_t seen) {
  const InHeader& header = areas.header();
  // On a shared core, the daemon has usually sent the operation when this thread runs again. If not, more
  // yields do not help: the daemon waits for something else, or the scheduler favours this thread.
  if (header.yields.load() != 0 && header.go.load() == seen) sched_yield();
  std::atomic<std::uint32_t>& sleeps = areas.out_header().sleeps;
  while (header.go.load() == seen) {
    sleeps.store(1);
    FutexWait(header.go, seen, 0);
    sleeps.store(0);
  }
}

[[noreturn]] void Serve(const Files& files) {
  Areas areas{{files[0], false}, {files[1], true}};
  auto runner = std::make_unique<Runner>();
  std::unique_ptr<WorkerPool> pool;
  for (std::uint32_t seen = 0;;) {
    AwaitOrder(areas, seen);
    seen = areas.header().go.load();
    areas.in.Remap(areas.header().in_bytes);
    areas.out.Remap(areas.header().out_bytes);
    const InHeader& header = areas.header();
    if (!pool) {
      pool = std::make_unique<WorkerPool>(static_cast<int>(header.workers));
      LimitMemory(header.memory_bytes);
      Runner::EndWithoutMemory();
    }
    const bool last = header.operation == Operation::kEnd;
    runner->Run(areas, *pool);
    if (last) {
      // Unload the controllers before the reply: after it the next set may start, and nobody waits for this
      // process.
      runner.reset();
      std::fflush(nullptr);
    }
    std::atomic<std::uint32_t>& reply = areas.out_header().reply;
    reply.store(seen);
    if (areas.header().yields.load() == 0) FutexWake(reply);
    if (last) _exit(0);  // destroying static objects takes longer than starting a new process
  }
}

/// The main program of a copy.
int RunCopy(const Files& files, pid_t its_template) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // dies with the template, whatever the controllers do
  if (getppid() != its_template) return 1;
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGCHLD, SIG_DFL);
  setpgid(0, 0);  // a controller that signals its process group reaches only this process
  // If a controller forks this process, the fork must exit: it would act as this process.
  pthread_atfork(nullptr, nullptr, [] { _exit(0); });
  prctl(PR_SET_NAME, "coopdyn-ctrl");
  try {
    Serve(files);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "coopdyn: the controllers' process: %s\n", exception.what());
    return 1;
  }
}

/// Receives the files of the next message. False if the daemon has ended.
bool Receive(int socket, Files& files) {
  char byte = 0;
  iovec bytes{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(files))> room{};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  if (TEMP_FAILURE_RETRY(recvmsg(socket, &message, 0)) != 1) return false;
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header == nullptr || header->cmsg_type != SCM_RIGHTS || header->cmsg_len != CMSG_LEN(sizeof(files))) {
    return false;
  }
  std::memcpy(&files, CMSG_DATA(header), sizeof(files));
  return true;
}

/// Reports ended copies to the daemon.
void ReportEnds(int socket) {
  CopyReport report;
  report.ended = true;
  int status = 0;
  rusage usage{};
  while ((report.pid = wait4(-1, &status, WNOHANG, &usage)) > 0) {
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    report.end = ChildEnd::Of(status);
    report.end.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    report.end.memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
    send(socket, &report, sizeof(report), MSG_NOSIGNAL);
  }
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
  // Ignore signals that a batch system or a terminal sends to all processes: the daemon ends this process in
  // order. Use handlers, not SIG_IGN: exec() resets handlers, so programs that a controller starts get
  // signals as usual.
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGCHLD}) std::signal(signal, [](int) {});
  prctl(PR_SET_NAME, "coopdyn-ctrl-0");
  sigset_t ends, before;
  sigemptyset(&ends);
  sigaddset(&ends, SIGCHLD);
  sigprocmask(SIG_BLOCK, &ends, &before);
  for (;;) {
    ReportEnds(fd);
    pollfd request{fd, POLLIN, 0};
    if (ppoll(&request, 1, nullptr, &before) < 0) continue;  // a copy has ended, or a signal for the daemon
    Files files{};
    if (!Receive(fd, files)) return 0;
    CopyReport report;
    const pid_t self = getpid();
    report.pid = fork();
    report.error = errno;
    if (report.pid == 0) {
      close(fd);
      return RunCopy(files, self);
    }
    for (const int file : files) close(file);
    if (send(fd, &report, sizeof(report), MSG_NOSIGNAL) != sizeof(report)) return 0;
  }
}

}  // namespace coopdyn
