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
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <initializer_list>
#include <mutex>
#include <stop_token>
#include <system_error>

namespace coopdyn {

namespace {

sigset_t SetOf(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

}  // namespace

Shutdown::Shutdown() {
  sigset_t set = SetOf({SIGINT, SIGTERM, SIGHUP, SIGUSR1});
  struct sigaction at_hangup {};
  ::sigaction(SIGHUP, nullptr, &at_hangup);
  if (at_hangup.sa_handler == SIG_IGN) sigdelset(&set, SIGHUP);  // under nohup, outlive the terminal
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
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
  // Without a process to follow, poll ignores the descriptor -1.
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

EndsAtOnce::EndsAtOnce()
    : takes_signals_([](const std::stop_token& stop) {
        pthread_setname_np(pthread_self(), "signals");
        // The only thread that does not block these signals, so it receives them.
        const sigset_t ends = SetOf({SIGINT, SIGTERM, SIGHUP});
        pthread_sigmask(SIG_UNBLOCK, &ends, nullptr);
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any().wait(lock, stop, [] { return false; });
      }) {}

}  // namespace coopdyn
