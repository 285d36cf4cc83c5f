// SPDX-License-Identifier: MIT
#include "server/timing/urgent_thread.h"

#include <sys/resource.h>

#include <algorithm>

namespace coopdyn {

namespace {

/// Ten times the weight of a usual thread; still not real-time scheduling, with which an endless loop would
/// take the machine.
constexpr int kUrgent = -10;

}  // namespace

// On Linux 0 is the calling thread, not its process.
UrgentThread::UrgentThread() : usual_(getpriority(PRIO_PROCESS, 0)) {}

bool UrgentThread::Set(bool urgent) {
  if (urgent == urgent_) return true;
  urgent_ = urgent;
  return setpriority(PRIO_PROCESS, 0, urgent ? std::min(usual_, kUrgent) : usual_) == 0;
}

}  // namespace coopdyn
