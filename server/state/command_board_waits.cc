// SPDX-License-Identifier: MIT
// The part of the board that finds reading programs that lockstep waits for, and measures how long the world
// waits.
#include <algorithm>
#include <utility>

#include "server/state/command_board.h"

namespace coopdyn {

void CommandBoard::NoteSampleTaken(std::uint64_t id, const std::string& name, std::uint64_t step, int every) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    const bool was_ready = programs_.empty() || IsReady();
    const std::uint64_t last = last_frame_ == nullptr ? 0 : last_frame_->step;
    // A new reader is not sent steps that ended before it registered.
    Reader& reader =
        readers_.try_emplace(id, Reader{name, last, static_cast<std::uint64_t>(every)}).first->second;
    // A later step is either the one about to be reported, or of a run before a reset.
    if (step <= last + 1) reader.taken = std::max(reader.taken, step);
    became_ready = !was_ready && IsReady();
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

void CommandBoard::ForgetReader(std::uint64_t id) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    const bool was_ready = programs_.empty() || IsReady();
    readers_.erase(id);
    became_ready = !was_ready && IsReady();
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

std::string CommandBoard::LackOf(const std::string& program) const {
  if (playing_ || last_frame_ == nullptr) return {};
  bool reads = false;
  for (const auto& [id, reader] : readers_) {
    if (!reader.name.starts_with(program)) continue;
    if (reader.name.size() > program.size() && reader.name[program.size()] != '/') continue;
    reads = true;
    if (reader.taken + reader.every <= last_frame_->step)
      return reader.name + " has not taken the sample of step " + std::to_string(last_frame_->step);
  }
  return reads ? "" : "it reads none of our ports by tcp or text_ack";
}

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
