// SPDX-License-Identifier: MIT
// The events that the main thread waits for: SIGINT, SIGTERM, SIGHUP, `quit` and the end of the run end the
// daemon; SIGUSR1 requests a report. Under nohup SIGHUP does nothing.
#pragma once

#include <csignal>
#include <string>
#include <thread>

#include "server/base/clock.h"

namespace coopdyn {

class Shutdown {
 public:
  enum class Wake { kTimeout, kEnd, kReport };

  /// Blocks the four signals in this thread and in all threads that it starts afterwards: construct it before
  /// any thread.
  Shutdown();
  ~Shutdown();
  Shutdown(const Shutdown&) = delete;
  Shutdown& operator=(const Shutdown&) = delete;

  /// Makes Wait() return kEnd. Any thread.
  void Request();
  /// Makes Wait() return kEnd also when `process` ends, however it ends. Returns an error text, empty if the
  /// process exists.
  std::string Follow(int process);
  /// Waits at most `timeout` (negative: forever).
  Wake Wait(Nanoseconds timeout);

 private:
  int signals_ = -1;  // signalfd
  int request_ = -1;  // eventfd
  int process_ = -1;  // pidfd; -1: none
};

/// During its lifetime, SIGINT, SIGTERM and SIGHUP kill the process at once, as if they were not blocked: for
/// the start, when nothing depends on the daemon yet. Construct it after the Shutdown.
class EndsAtOnce {
 public:
  EndsAtOnce();

 private:
  std::jthread takes_signals_;
};

}  // namespace coopdyn
