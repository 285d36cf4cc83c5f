// SPDX-License-Identifier: MIT
// Notices that a run in real time loses time, and finds out who takes it: who uses the cores of this machine,
// as /proc says it. One thread, which says what time it
// is.
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

/// The threads of this process alone, which takes microseconds for each. Any thread.
std::vector<CpuUser> ReadThreadUse();

/// Those of one name together.
struct CpuShare {
  std::string name;
  int count = 0;
  double cores = 0;  // 1: one whole core
};
/// Who used the cores in the time `wall` from `before` to `after`; most first.
std::vector<CpuShare> SharesOf(const std::vector<CpuUser>& before, const std::vector<CpuUser>& after,
                               Nanoseconds wall);

class OverloadWatch {
 public:
  static constexpr Nanoseconds kWindow = 2 * kNanosecondsPerSecond;
  static constexpr Nanoseconds kAgainAfter = 60 * kNanosecondsPerSecond;
  static constexpr double kMostLost = 0.05;  // of the real time of a window

  /// `read_use` is called only while time is lost.
  explicit OverloadWatch(std::function<CpuUse()> read_use = ReadCpuUse) : read_use_(std::move(read_use)) {}

  /// Looks at the run; once a second will do. A warning when two windows in a row have lost too much, at most
  /// one each kAgainAfter; else empty.
  std::string Look(Nanoseconds now, const RunStatus& status);

 private:
  struct Moment {
    Nanoseconds now = 0;
    RunStatus status;
  };

  const std::function<CpuUse()> read_use_;
  std::optional<Moment> from_;  // begin of the window
  std::optional<CpuUse> use_;   // then, if the window before lost too much
  std::optional<Nanoseconds> said_;
};

/// Part of the real time from `before` to `after`, `wall` apart, that was skipped.
double LostPart(const RunStatus& before, const RunStatus& after, Nanoseconds wall);
/// What a step takes between `before` and `after`, by its parts; empty if there was none.
std::string DescribeSteps(const RunStatus& before, const RunStatus& after);
/// Who kept the cores busy in the time `wall` from `before` to `after`; empty: nobody else.
std::string DescribeOthers(const CpuUse& before, const CpuUse& after, Nanoseconds wall);

}  // namespace coopdyn
