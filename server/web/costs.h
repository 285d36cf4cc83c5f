// SPDX-License-Identifier: MIT
// Who slows the run: what a step costs by its parts, on average over the last second and since the last
// reset, as JSON. The caller says what was measured and when. One thread.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "server/state/command_board.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// What was measured until `now`.
struct CostSnapshot {
  /// A thread of the daemon that works beside the steps.
  struct Thread {
    std::string name;
    std::int64_t id = 0;
    Nanoseconds cpu = 0;
  };

  Nanoseconds now = 0;
  Mode mode = Mode::kRealtime;
  bool playing = false;  // a recording: nothing is computed
  bool recording = false;
  StepCosts costs = {};
  CommandBoard::Waits waits = {};
  std::vector<Thread> threads = {};
};

class CostBook {
 public:
  static constexpr Nanoseconds kWindow = kNanosecondsPerSecond;
  static constexpr Nanoseconds kOldest = 5 * kNanosecondsPerSecond;
  static constexpr Nanoseconds kLeastApart = kWindow / 10;  // of two that are kept
  static constexpr std::size_t kMaxRobots = 64;  // that are listed; those that are waited for longest

  /// {"steps":…,"steps_last":…,"mode":…,"playback":…,"parts":[{"part":"physics","last_ms":…,"all_ms":…},…],
  /// "clients":[{"name":…,"client":…,"robots":1,"last_ms":…,"all_ms":…,"alone_last_ms":…,"alone_all_ms":…},…],
  /// "threads":[{"name":…,"count":…,"last_ms":…,"cores":…},…]}: milliseconds per step; null: not known yet.
  std::string Json(const CostSnapshot& snapshot);

 private:
  /// The newest that is at least kWindow old; null: there is none of this run.
  const CostSnapshot* Before(Nanoseconds now) const;
  void Keep(const CostSnapshot& snapshot);

  std::deque<CostSnapshot> kept_;  // of one run; the oldest first
};

}  // namespace coopdyn
