// SPDX-License-Identifier: MIT
// Detects that a real-time run loses time, and finds out from /proc which programs use the CPU. One thread,
// which passes the time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// A process, or a thread of this process.
struct CpuUser {
  std::int64_t id = 0;
  std::string name;  // printable
  Nanoseconds cpu = 0;
};

/// The CPU time used so far.
struct CpuUse {
  std::vector<CpuUser> others;   // processes
  std::vector<CpuUser> threads;  // of this process
  Nanoseconds busy = 0;          // of all cores, used by anybody; 0: unknown
};

/// Parses the `stat` file of a process or thread; nullopt if malformed.
std::optional<CpuUser> ParseProcessStat(std::string_view text, Nanoseconds tick);
/// Parses the busy time of all cores from the text of /proc/stat; 0 if malformed.
Nanoseconds ParseBusyTime(std::string_view text, Nanoseconds tick);
/// Needs some milliseconds with hundreds of processes. Any thread.
CpuUse ReadCpuUse();

/// Only the threads of this process, some microseconds per thread. Any thread.
std::vector<CpuUser> ReadThreadUse();

/// The CPU use of all users of one name.
struct CpuShare {
  std::string name;
  int count = 0;
  double cores = 0;  // 1: one whole core
};
/// CPU use within the time `wall` from `before` to `after`, largest first.
std::vector<CpuShare> SharesOf(const std::vector<CpuUser>& before, const std::vector<CpuUser>& after,
                               Nanoseconds wall);

class OverloadWatch {
 public:
  static constexpr Nanoseconds kWindow = 2 * kNanosecondsPerSecond;
  static constexpr Nanoseconds kAgainAfter = 60 * kNanosecondsPerSecond;
  static constexpr double kMostLost = 0.05;  // of the real time of a window

  /// `read_use` is called only while real time is lost.
  explicit OverloadWatch(std::function<CpuUse()> read_use = ReadCpuUse) : read_use_(std::move(read_use)) {}

  /// Checks the run; call it about once a second. Returns a warning if two consecutive windows have lost too
  /// much time, at most one per kAgainAfter; else empty.
  std::string Look(Nanoseconds now, const RunStatus& status);

 private:
  struct Moment {
    Nanoseconds now = 0;
    RunStatus status;
  };

  const std::function<CpuUse()> read_use_;
  std::optional<Moment> from_;  // start of the window
  std::optional<CpuUse> use_;   // at that time, if the previous window lost too much
  std::optional<Nanoseconds> warned_at_;
};

/// Fraction of the real time `wall` from `before` to `after` that was skipped.
double LostPart(const RunStatus& before, const RunStatus& after, Nanoseconds wall);
/// The cost of a step between `before` and `after`, by its parts; empty if there was no step.
std::string DescribeSteps(const RunStatus& before, const RunStatus& after);
/// Describes who used the CPU in the time `wall` from `before` to `after`; empty if nobody else.
std::string DescribeOthers(const CpuUse& before, const CpuUse& after, Nanoseconds wall);

}  // namespace coopdyn
