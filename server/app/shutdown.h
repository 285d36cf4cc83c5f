// SPDX-License-Identifier: MIT
// What the main thread waits for: SIGINT, SIGTERM, SIGHUP, `quit` and the end of the run end the daemon;
// SIGUSR1 asks how the run stands. Under nohup SIGHUP does nothing.
#pragma once

#include <csignal>
#include <string>
#include <thread>

#include "server/base/clock.h"

namespace coopdyn {

class Shutdown {
 public:
  enum class Wake { kTimeout, kEnd, kReport };

  /// Blocks the four signals in this thread and in all that it starts afterwards: construct before any
  /// thread.
  Shutdown();
  ~Shutdown();
  Shutdown(const Shutdown&) = delete;
  Shutdown& operator=(const Shutdown&) = delete;

  /// Ends the wait. Any thread.
  void Request();
  /// Ends the wait, too, when this process ends, however it ends. An error text; empty: it is there.
  std::string Follow(int process);
  /// Waits at most `timeout` (negative: for ever).
  Wake Wait(Nanoseconds timeout);

 private:
  int signals_ = -1;  // signalfd
  int request_ = -1;  // eventfd
  int process_ = -1;  // pidfd; -1: none
};

/// While it lives, SIGINT, SIGTERM and SIGHUP end the process at once, as if nobody held them back: for the
/// start, when nobody relies on the daemon yet. Construct after the Shutdown.
class EndsAtOnce {
 public:
  EndsAtOnce();

 private:
  std::jthread takes_signals_;
};

}  // namespace coopdyn
