// SPDX-License-Identifier: MIT
// The part of the board that measures for whom a lockstep world waits, and how long.
#include <algorithm>
#include <utility>

#include "server/state/command_board.h"

namespace coopdyn {

void CommandBoard::NoteReady(std::size_t index, bool last, std::optional<Nanoseconds>& now) {
  if (wait_clock_ == nullptr || waits_from_ == 0) return;
  if (!now) now = wait_clock_->Now();
  if (*now > newest_ready_) ready_before_ = std::exchange(newest_ready_, *now);
  WaitTimes& times = wait_times_[table_.drive(index).robot];
  times.waited += *now - waits_from_;
  if (!last) return;
  times.alone += *now - std::max(ready_before_, waits_from_);
  waited_ += *now - waits_from_;
}

void CommandBoard::IgnoreWait() {
  const MutexLock lock(mutex_);
  waits_from_ = 0;
}

CommandBoard::Waits CommandBoard::waits() const {
  const MutexLock lock(mutex_);
  Waits waits;
  waits.total = waited_;
  for (std::size_t robot = 0; robot < wait_times_.size() && robot < table_.robot_count(); ++robot) {
    const WaitTimes& times = wait_times_[robot];
    if (times.waited == 0) continue;
    const std::size_t first = table_.first_slot(robot);
    waits.robots.push_back({table_.slot(first).robot, table_.Who(first), table_.slot(first).owner.is_team,
                            times.waited, times.alone});
  }
  return waits;
}

}  // namespace coopdyn
