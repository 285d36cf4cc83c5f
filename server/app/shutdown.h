// SPDX-License-Identifier: MIT
// What the main thread waits for: SIGINT, SIGTERM, SIGHUP, `quit` and the end of the run end the daemon;
// SIGUSR1 asks how the run stands.
#pragma once

#include <csignal>

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
  /// Waits at most `timeout` (negative: for ever).
  Wake Wait(Nanoseconds timeout);

 private:
  int signals_ = -1;  // signalfd
  int request_ = -1;  // eventfd
};

}  // namespace coopdyn
