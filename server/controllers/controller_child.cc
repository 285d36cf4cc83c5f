// SPDX-License-Identifier: MIT
#include "server/controllers/controller_child.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <memory>
#include <thread>

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
    char byte = 0;
    ssize_t got = 0;
    do {
      got = recv(socket_, &byte, 1, 0);
    } while (got > 0 || (got < 0 && errno == EINTR));
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

int Serve(int fd) {
  const ParentWatch watch(fd);
  const SharedArea head(fd + 1, sizeof(InHeader), false);
  const InHeader& header = *head.At<InHeader>(0);
  SharedArea in, out;
  Runner runner;
  std::unique_ptr<WorkerPool> pool;
  for (std::uint32_t seen = 0;;) {
    while (header.go.load(std::memory_order_acquire) == seen) FutexWait(header.go, seen, 0);
    seen = header.go.load(std::memory_order_acquire);
    if (in.bytes() != header.in_bytes) in = SharedArea(fd + 1, header.in_bytes, false);
    if (out.bytes() != header.out_bytes) out = SharedArea(fd + 2, header.out_bytes, true);
    if (!pool) pool = std::make_unique<WorkerPool>(static_cast<int>(header.workers));
    const bool last = header.operation == Operation::kEnd;
    runner.Run(in.data(), out.data(), *pool);
    std::atomic<std::uint32_t>& reply = out.At<OutHeader>(0)->reply;
    reply.store(seen, std::memory_order_release);
    FutexWake(reply);
    if (last) return 0;
  }
}

}  // namespace

int RunControllerChild(int fd) {
  if (fcntl(fd, F_GETFD) < 0 || fcntl(fd + 1, F_GETFD) < 0 || fcntl(fd + 2, F_GETFD) < 0) {
    std::fputs("coopdyn: controller-child is started by coopdyn serve itself; write coopdyn serve SCENARIO\n",
               stderr);
    return 2;
  }
  NoCoreFiles();
  // A copy that a controller makes of this process would go on as if it were the process itself.
  pthread_atfork(nullptr, nullptr, [] { _exit(0); });
  prctl(PR_SET_NAME, "coopdyn-ctrl");
  try {
    return Serve(fd);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "coopdyn: the controllers' process: %s\n", exception.what());
    return 1;
  }
}

}  // namespace coopdyn
