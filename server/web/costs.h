// SPDX-License-Identifier: MIT
// What slows the run: the cost of a step by its parts, averaged over the last second and since the last
// reset, as JSON. The caller supplies the measurements and their time. One thread.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "server/state/command_board.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// Measurements up to `now`.
struct CostSnapshot {
  /// A thread of the daemon and its CPU time.
  struct Thread {
    std::string name;
    std::int64_t id = 0;
    Nanoseconds cpu = 0;
  };

  Nanoseconds now = 0;
  Mode mode = Mode::kRealtime;
  bool playing = false;  // a recording: no physics
  bool recording = false;
  StepCosts costs = {};
  CommandBoard::Waits waits = {};
  std::vector<Thread> threads = {};
};

class CostBook {
 public:
  static constexpr Nanoseconds kWindow = kNanosecondsPerSecond;
  static constexpr Nanoseconds kOldest = 5 * kNanosecondsPerSecond;
  static constexpr Nanoseconds kLeastApart = kWindow / 10;  // between two kept snapshots
  static constexpr std::size_t kMaxRobots = 64;             // clients listed: the ones waited for longest

  /// {"steps":…,"steps_last":…,"mode":…,"playback":…,"parts":[{"part":"physics","last_ms":…,"all_ms":…},…],
  /// "clients":[{"name":…,"client":…,"robots":1,"last_ms":…,"all_ms":…,"alone_last_ms":…,"alone_all_ms":…},…],
  /// "threads":[{"name":…,"count":…,"last_ms":…,"cores":…},…]}: milliseconds per step; null if not yet known.
  std::string Json(const CostSnapshot& snapshot);

 private:
  /// The newest snapshot between kWindow and kOldest old; null if none.
  const CostSnapshot* Before(Nanoseconds now) const;
  void Keep(const CostSnapshot& snapshot);

  std::deque<CostSnapshot> kept_;  // of one run; the oldest first
};

}  // namespace coopdyn
