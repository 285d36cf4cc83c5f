// SPDX-License-Identifier: MIT
// Notices that a run in real time loses time, and finds out who takes it. One thread, which says what time it
// is.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "server/state/run_control.h"
#include "server/timing/cpu_users.h"

namespace coopdyn {

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
