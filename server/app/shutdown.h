// SPDX-License-Identifier: MIT
// Why the daemon ends: SIGINT, SIGTERM, SIGHUP, `quit`, or the end of the run. The main thread waits for it.
#pragma once

#include <csignal>

#include "server/base/clock.h"

namespace coopdyn {

class Shutdown {
 public:
  /// Blocks the three signals in this thread and in all that it starts afterwards: construct before any
  /// thread.
  Shutdown();
  ~Shutdown();
  Shutdown(const Shutdown&) = delete;
  Shutdown& operator=(const Shutdown&) = delete;

  /// Ends the wait. Any thread.
  void Request();
  /// Waits for the end, at most `timeout` (negative: for ever). True if it has come.
  bool Wait(Nanoseconds timeout);

 private:
  int signals_ = -1;  // signalfd
  int request_ = -1;  // eventfd
};

}  // namespace coopdyn
