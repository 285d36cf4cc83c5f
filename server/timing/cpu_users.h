// SPDX-License-Identifier: MIT
// Who uses the cores of this machine, as /proc says it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/clock.h"

namespace coopdyn {

/// A process, or a thread of this one.
struct CpuUser {
  std::int64_t id = 0;
  std::string name;  // printable
  Nanoseconds cpu = 0;
};

/// The CPU time used so far.
struct CpuUse {
  std::vector<CpuUser> others;   // processes
  std::vector<CpuUser> threads;  // of this process
  Nanoseconds busy = 0;          // of all cores, by whatever; 0: unknown
};

/// The text of a `stat` file of a process or thread; nothing if it is none.
std::optional<CpuUser> ParseProcessStat(std::string_view text, Nanoseconds tick);
/// The time that all cores were busy, of the text of /proc/stat; 0 if it is none.
Nanoseconds ParseBusyTime(std::string_view text, Nanoseconds tick);
/// Takes some milliseconds with hundreds of processes. Any thread.
CpuUse ReadCpuUse();

/// Those of one name together.
struct CpuShare {
  std::string name;
  int count = 0;
  double cores = 0;  // 1: one whole core
};
/// Who used the cores in the time `wall` from `before` to `after`; most first.
std::vector<CpuShare> SharesOf(const std::vector<CpuUser>& before, const std::vector<CpuUser>& after,
                               Nanoseconds wall);

}  // namespace coopdyn
