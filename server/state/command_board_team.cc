// SPDX-License-Identifier: MIT
// The part of the board that acts on many robots at once, for /swarm: one lock and one callback for a batch.
#include <algorithm>
#include <utility>

#include "server/state/command_board.h"

namespace coopdyn {

Verdict CommandBoard::StepAll(const TeamStep& step, const Client& client, int steps, StepDone done) {
  if (step.setpoints.empty() && WaitInPlayback(steps, done)) {
    return {.answer_now = false};
  }
  Completions completions;
  Verdict verdict;
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    for (const SlotId id : step.slots) {
      const std::size_t index = Find(id);
      if (index == kNoSlot) return Gone();
      if (drives_[index].owner == client.id && !stopping_ && !playing_) continue;
      if (std::optional<Verdict> objection = TeamObjection(index, client)) return *std::move(objection);
    }
    completions = MakeCompletions();
    const std::uint64_t batch = next_batch_++;
    Waiter waiter{batch, 0, steps, false, std::move(done), 0};
    const auto place = [&](std::size_t index, std::span<const Setpoint> setpoints) REQUIRES(mutex_) {
      const bool was_awaited = IsAwaited(drives_[index]);
      TakeOwnership(index, client);
      ReplacePending(index, client, completions);
      SetPending(index, client, setpoints, steps);
      drives_[index].batch = batch;
      ++waiter.members;
      became_ready |= NoteChange(index, was_awaited);
    };
    std::span<const Setpoint> left = step.setpoints;
    for (const SlotId id : step.slots) {
      const std::size_t index = Find(id),
                        count = std::min<std::size_t>(drives_[index].channel_count, left.size());
      place(index, left.first(count));
      left = left.subspan(count);
    }
    for (const SlotId id : step.others) {
      const std::size_t index = Find(id);
      if (index != kNoSlot && IsOf(index, client.id)) place(index, {});
    }
    waiters_.push_back(std::move(waiter));
    verdict = Fine();
    verdict.answer_now = false;
  }
  completions.Call();
  if (became_ready && all_ready_hook_) all_ready_hook_();
  return verdict;
}

std::optional<Verdict> CommandBoard::TeamObjection(std::size_t index, const Client& client) const {
  if (!drives_[index].has_module) {
    return Verdict{Error::kNotPossible, slots_[index].robot + " has no actuators: it can only be read"};
  }
  return Objection(index, client);
}

bool CommandBoard::IsOf(std::size_t index, ClientId client) const {
  const ClientId owner = drives_[index].owner;
  return owner == client || (owner == 0 && slots_[index].former.id == client);
}

Verdict CommandBoard::ClaimAll(std::span<const SlotId> slots, const Client& client) {
  const MutexLock lock(mutex_);
  for (const SlotId id : slots) {
    const std::size_t index = Find(id);
    if (index == kNoSlot) return Gone();
    if (std::optional<Verdict> objection = TeamObjection(index, client)) return *std::move(objection);
  }
  for (const SlotId id : slots) TakeOwnership(Find(id), client);
  return Fine();
}

Verdict CommandBoard::ClaimFree(const Client& client) {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i].owner == 0 && !TeamObjection(i, client)) TakeOwnership(i, client);
  }
  return Fine();
}

Verdict CommandBoard::ReleaseAll(std::span<const SlotId> slots, const Client& client) {
  const MutexLock lock(mutex_);
  for (const SlotId id : slots) {
    const std::size_t index = Find(id);
    if (index == kNoSlot) return Gone();
    const Drive& drive = drives_[index];
    if (drive.owner == client.id || (drive.owner == 0 && !drive.driven)) continue;
    return NotOwner(index);
  }
  for (const SlotId id : slots) {
    const std::size_t index = Find(id);
    if (drives_[index].owner == client.id) Disown(index);
    if (slots_[index].former.id == client.id) slots_[index].former.id = 0;
  }
  return Fine();
}

void CommandBoard::StopTeam(std::span<const SlotId> slots, const Client& client) {
  const MutexLock lock(mutex_);
  for (const SlotId id : slots) {
    const std::size_t index = Find(id);
    if (index == kNoSlot || !IsOf(index, client.id)) continue;
    StopPending(index);
  }
}

std::vector<ClientId> CommandBoard::HelloAll(const Client& client) {
  const MutexLock lock(mutex_);
  std::vector<ClientId> displaced;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Drive& drive = drives_[i];
    Slot& slot = slots_[i];
    if (drive.owner == client.id) {
      slot.owner.name = client.name;
    } else if (drive.owner != 0 && slot.owner.is_team && slot.owner.name == client.name &&
               !client.name.empty()) {
      if (std::find(displaced.begin(), displaced.end(), drive.owner) == displaced.end())
        displaced.push_back(drive.owner);
      drive.owner = client.id;
      slot.owner = client;
    }
  }
  if (!displaced.empty()) NoteTeams();
  return displaced;
}

void CommandBoard::InputEndedAll(ClientId client) {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i].owner == client) EndInput(i);
  }
}

void CommandBoard::ClosedAll(ClientId client) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      if (!IsOf(i, client)) continue;
      const bool was_awaited = IsAwaited(drives_[i]);
      LoseClient(i);
      became_ready |= NoteChange(i, was_awaited);
    }
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

std::vector<SlotId> CommandBoard::Team(ClientId client) const {
  const MutexLock lock(mutex_);
  std::vector<SlotId> team;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (IsOf(i, client)) team.push_back(slots_[i].id);
  }
  return team;
}

}  // namespace coopdyn
