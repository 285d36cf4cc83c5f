// SPDX-License-Identifier: MIT
#include "server/app/shutdown.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace coopdyn {

Shutdown::Shutdown() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) sigaddset(&set, signal);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signals_ = ::signalfd(-1, &set, SFD_CLOEXEC);
  request_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
}

Shutdown::~Shutdown() {
  ::close(signals_);
  ::close(request_);
  if (process_ >= 0) ::close(process_);
}

void Shutdown::Request() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(request_, &one, sizeof one);
}

std::string Shutdown::Follow(int process) {
  process_ = static_cast<int>(::syscall(SYS_pidfd_open, process, 0));
  return process_ >= 0 ? "" : std::system_category().message(errno);
}

Shutdown::Wake Shutdown::Wait(Nanoseconds timeout) {
  // A process that there is none of is never waited for: poll takes no notice of -1.
  std::array<pollfd, 3> waiting{pollfd{signals_, POLLIN, 0}, pollfd{request_, POLLIN, 0},
                                pollfd{process_, POLLIN, 0}};
  const timespec limit{timeout / kNanosecondsPerSecond, timeout % kNanosecondsPerSecond};
  int ready;
  do {
    ready = ::ppoll(waiting.data(), waiting.size(), timeout < 0 ? nullptr : &limit, nullptr);
  } while (ready < 0 && errno == EINTR);
  if (ready <= 0) return Wake::kTimeout;
  if (waiting[1].revents != 0 || waiting[2].revents != 0) return Wake::kEnd;
  signalfd_siginfo got{};
  const bool asks = ::read(signals_, &got, sizeof got) == sizeof got && got.ssi_signo == SIGUSR1;
  return asks ? Wake::kReport : Wake::kEnd;
}

}  // namespace coopdyn
