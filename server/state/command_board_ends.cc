// SPDX-License-Identifier: MIT
// The part of the board for clients that leave or fall silent: finds ended clients, frees their robots, and
// applies policies.
#include <algorithm>
#include <utility>

#include "server/state/command_board.h"

namespace coopdyn {

// --- ends noticed by other clients

bool CommandBoard::FreeIfEnded(const Holder& holder) {
  if (holder.id == 0 || holder.input_end == nullptr || !holder.input_end->Look()) return false;
  InputEndedAll(holder.id);
  return true;
}

std::string CommandBoard::ClientBeside(SlotId slot, const Client& client) {
  const Verdict verdict = Insist([&]() -> Verdict {
    const MutexLock lock(mutex_);
    const std::size_t index = table_.Find(slot);
    if (index == kNoSlot || !IsHeldBeside(index, client)) return {};
    return {.text = table_.Who(index), .holder = HolderOf(index)};
  });
  return verdict.text;
}

// --- ends reported by connections

void CommandBoard::InputEnded(SlotId id, ClientId client) {
  const MutexLock lock(mutex_);
  const std::size_t index = table_.Find(id);
  if (index != kNoSlot && table_.drive(index).owner == client) EndInput(index);
}

void CommandBoard::InputEndedAll(ClientId client) {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_.drive(i).owner == client) EndInput(i);
  }
}

void CommandBoard::Closed(SlotId id, ClientId client) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    const std::size_t index = table_.Find(id);
    if (index == kNoSlot || !table_.IsOf(index, client)) return;
    const bool was_awaited = table_.drive(index).is_awaited();
    LoseClient(index);
    std::optional<Nanoseconds> now;
    became_ready = NoteChange(index, was_awaited, now);
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

void CommandBoard::ClosedAll(ClientId client) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    std::optional<Nanoseconds> now;
    for (std::size_t i = 0; i < table_.size(); ++i) {
      if (!table_.IsOf(i, client)) continue;
      const bool was_awaited = table_.drive(i).is_awaited();
      LoseClient(i);
      became_ready |= NoteChange(i, was_awaited, now);
    }
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

// --- the robots

void CommandBoard::EndInput(std::size_t index) {
  table_.slot(index).former = table_.slot(index).owner;
  Disown(index);
}

void CommandBoard::LoseClient(std::size_t index) {
  if (table_.drive(index).owner != 0) EndInput(index);
  table_.slot(index).former.id = 0;
  if (table_.drive(index).pending) {
    table_.drive(index).loses_client = true;
  } else {
    ApplyLoss(index);
  }
}

void CommandBoard::ApplyLoss(std::size_t index) {
  const Slot& slot = table_.slot(index);
  if (slot.on_disconnect) {
    table_.ApplyPolicy(index, *slot.on_disconnect);
    if (*slot.on_disconnect != LossPolicy::kWait) NoteLoss(index, *slot.on_disconnect);
  } else if (!slot.former.name.empty()) {
    table_.drive(index).abandoned = true;
    if (mode_ != Mode::kLockstep) StopAbandoned(index);
  }
}

void CommandBoard::StopAbandoned(std::size_t index, Nanoseconds silent) {
  table_.drive(index).abandoned = false;
  if (!table_.Moves(index)) return;
  table_.Stop(index);
  table_.drive(index).silenced = silent > 0;
  NoteLoss(index, LossPolicy::kStop, silent);
}

void CommandBoard::NoteLoss(std::size_t index, LossPolicy policy, Nanoseconds silent) {
  const Slot& slot = table_.slot(index);
  losses_.push_back(
      {table_.drive(index).robot, (silent > 0 ? slot.owner : slot.former).shown(), policy, silent});
}

// --- clients that are connected but silent

void CommandBoard::HearOn(std::size_t robot, const Client& client, Nanoseconds now) {
  for (std::size_t i = table_.first_slot(robot); i < table_.first_slot(robot + 1); ++i) {
    if (table_.drive(i).owner != 0 && client.SpeaksFor(table_.slot(i).owner)) table_.slot(i).heard = now;
  }
}

void CommandBoard::NoteHeard(SlotId id, const Client& client, Nanoseconds now) {
  const MutexLock lock(mutex_);
  const std::size_t index = table_.Find(id);
  if (index != kNoSlot) HearOn(table_.drive(index).robot, client, now);
}

void CommandBoard::NoteHeardAll(ClientId client, Nanoseconds now) {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_.drive(i).owner == client) table_.slot(i).heard = now;
  }
}

void CommandBoard::StopSilent(Nanoseconds now) {
  constexpr double kRemoteWatchdog_s = 5;
  const MutexLock lock(mutex_);
  if (mode_ != Mode::kRealtime) return;
  for (std::size_t i = 0; i < table_.size(); ++i) {  // a client with a pending request is not silent
    const DriveTable::Drive& drive = table_.drive(i);
    if (drive.pending && drive.owner != 0) HearOn(drive.robot, table_.slot(i).owner, now);
  }
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_.drive(i).owner == 0) continue;
    Slot& slot = table_.slot(i);
    if (!slot.heard) slot.heard = now;
    const double limit_s = slot.watchdog_s.value_or(slot.owner.is_remote ? kRemoteWatchdog_s : 0);
    const Nanoseconds silent = now - std::max(*slot.heard, silence_from_);
    if (limit_s > 0 && ToSeconds(silent) >= limit_s) StopAbandoned(i, silent);
  }
}

}  // namespace coopdyn
