// SPDX-License-Identifier: MIT
// The part of the board that robot and control threads call; command_board_steps.cc is the stepping thread's.
#include "server/state/command_board.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

constexpr std::size_t kNoSlot = static_cast<std::size_t>(-1);

Verdict Refusal(Error error, std::string text) {
  return {error, std::move(text), true, Mode::kRealtime, 0};
}

}  // namespace

CommandBoard::Slot* CommandBoard::Find(SlotId id) {
  if (id >= slot_index_.size() || slot_index_[id] == kNoSlot) return nullptr;
  return &slots_[slot_index_[id]];
}

SlotId CommandBoard::FindSlot(const std::string& robot) const {
  const MutexLock lock(mutex_);
  for (const Slot& slot : slots_) {
    if (slot.robot == robot) return slot.id;
  }
  return 0;
}

bool CommandBoard::IsAwaited(const Slot& slot) const {
  return slot.participates && !slot.dropped && !slot.excused && !slot.pending.active;
}

bool CommandBoard::NoteChange(const Slot& slot, bool was_awaited) {
  const bool is_awaited = IsAwaited(slot);
  if (was_awaited == is_awaited) return false;
  awaited_ += is_awaited ? 1 : -1;
  return awaited_ == 0 && mode_ == Mode::kLockstep;
}

void CommandBoard::Call(Completions& completions) {
  for (auto& [done, result] : completions) done(result);
}

Verdict CommandBoard::TakeOwnership(Slot& slot, const Client& client) {
  if (stopping_) return Refusal(Error::kNotPossible, "the daemon is stopping");
  if (slot.owner != 0 && slot.owner != client.id) {
    const std::string& who = slot.owner_name.empty() ? slot.owner_peer : slot.owner_name;
    return Refusal(
        Error::kOwned,
        slot.robot + " is driven by " + who +
            ": wait until that program ends, or free the robot (release_robot of /simulation, or the page)");
  }
  if (client.input_ended) {
    slot.former = client.id;
  } else {
    slot.owner = client.id;
    slot.owner_name = client.name;
    slot.owner_peer = client.peer;
    slot.former = 0;
    slot.after_pending.reset();
  }
  return {Error::kOk, {}, true, mode_, 0};
}

void CommandBoard::ReplacePending(Slot& slot, const Client& client, Completions& completions) {
  if (!slot.pending.active || slot.pending.client == client.id) return;
  if (slot.pending.done) {
    completions.emplace_back(std::move(slot.pending.done),
                             StepResult{StepEnd::kReplaced, last_frame_, mode_});
  }
  slot.pending = {};
}

Verdict CommandBoard::Place(SlotId id, const Client& client, const Setpoint* setpoint,
                            std::optional<int> steps, StepDone done) {
  Completions completions;
  Verdict verdict;
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    Slot* slot = Find(id);
    if (slot == nullptr) return Refusal(Error::kNotPossible, "this robot is no longer part of the scenario");
    const bool was_awaited = IsAwaited(*slot);
    verdict = TakeOwnership(*slot, client);
    if (verdict.error != Error::kOk) return verdict;
    ReplacePending(*slot, client, completions);
    slot->excused = false;
    slot->dropped = false;
    Pending& pending = slot->pending;
    if (setpoint != nullptr) {
      pending.setpoint = *setpoint;
    } else if (!pending.active) {
      pending.setpoint.reset();
    }
    pending.active = true;
    pending.latched = false;  // a step that runs now did not see it
    pending.client = client.id;
    pending.steps_left = steps.value_or(1);
    verdict.answer_now = !steps.has_value() && mode_ != Mode::kLockstep;
    pending.done = verdict.answer_now ? nullptr : std::move(done);
    became_ready = NoteChange(*slot, was_awaited);
  }
  Call(completions);
  if (became_ready && all_ready_hook_) all_ready_hook_();
  return verdict;
}

Verdict CommandBoard::Command(SlotId slot, const Client& client, const Setpoint& setpoint,
                              std::optional<int> steps, StepDone done) {
  return Place(slot, client, &setpoint, steps, std::move(done));
}

Verdict CommandBoard::Ready(SlotId slot, const Client& client, int steps, StepDone done) {
  return Place(slot, client, nullptr, steps, std::move(done));
}

Verdict CommandBoard::Claim(SlotId id, const Client& client) {
  const MutexLock lock(mutex_);
  Slot* slot = Find(id);
  if (slot == nullptr) return Refusal(Error::kNotPossible, "this robot is no longer part of the scenario");
  return TakeOwnership(*slot, client);
}

Verdict CommandBoard::Release(SlotId id, const Client& client) {
  const MutexLock lock(mutex_);
  Slot* slot = Find(id);
  if (slot == nullptr) return Refusal(Error::kNotPossible, "this robot is no longer part of the scenario");
  if (slot->owner == client.id) {
    slot->owner = 0;
    slot->owner_name.clear();
    slot->owner_peer.clear();
  } else if (slot->owner != 0) {
    return Refusal(Error::kOwned, slot->robot + " is driven by " +
                                      (slot->owner_name.empty() ? slot->owner_peer : slot->owner_name) +
                                      ": only its owner can release it");
  }
  return {Error::kOk, {}, true, mode_, 0};
}

Verdict CommandBoard::Hello(SlotId id, const Client& client) {
  const MutexLock lock(mutex_);
  Verdict verdict{Error::kOk, {}, true, mode_, 0};
  Slot* slot = Find(id);
  if (slot == nullptr || slot->owner == 0) return verdict;
  if (slot->owner == client.id) {
    slot->owner_name = client.name;
  } else if (!client.name.empty() && slot->owner_name == client.name) {
    verdict.displaced = slot->owner;
    slot->owner = client.id;
    slot->owner_peer = client.peer;
  }
  return verdict;
}

void CommandBoard::InputEnded(SlotId id, ClientId client) {
  const MutexLock lock(mutex_);
  Slot* slot = Find(id);
  if (slot == nullptr || slot->owner != client) return;
  slot->owner = 0;
  slot->owner_name.clear();
  slot->owner_peer.clear();
  slot->former = client;
}

void CommandBoard::Closed(SlotId id, ClientId client) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    Slot* slot = Find(id);
    if (slot == nullptr) return;
    const bool was_owner = slot->owner == client;
    const bool was_former = slot->owner == 0 && slot->former == client;
    if (!was_owner && !was_former) return;
    slot->owner = 0;
    slot->owner_name.clear();
    slot->owner_peer.clear();
    slot->former = 0;
    const LossPolicy policy = slot->on_disconnect.value_or(LossPolicy::kWait);
    if (slot->pending.active) {
      slot->after_pending = policy;
    } else {
      const bool was_awaited = IsAwaited(*slot);
      ApplyPolicy(*slot, policy);
      became_ready = NoteChange(*slot, was_awaited);
    }
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

void CommandBoard::ApplyPolicy(Slot& slot, LossPolicy policy) {
  switch (policy) {
    case LossPolicy::kWait:
      return;
    case LossPolicy::kHold:
      slot.excused = true;
      return;
    case LossPolicy::kStop:
      slot.in_force = {};
      slot.excused = true;
      return;
    case LossPolicy::kDrop:
      slot.in_force = {};
      slot.dropped = true;
      return;
  }
}

void CommandBoard::WaitSteps(int steps, StepDone done) {
  {
    const MutexLock lock(mutex_);
    if (!stopping_) {
      waiters_.push_back({steps, false, std::move(done)});
      return;
    }
  }
  done({StepEnd::kStopping, nullptr, Mode::kRealtime});
}

std::uint64_t CommandBoard::AddObserver(StepObserver observer) {
  const MutexLock lock(mutex_);
  observers_.push_back({next_observer_, std::make_shared<const StepObserver>(std::move(observer))});
  return next_observer_++;
}

void CommandBoard::RemoveObserver(std::uint64_t key) {
  const MutexLock lock(mutex_);
  std::erase_if(observers_, [key](const Observer& observer) { return observer.key == key; });
}

std::vector<CommandBoard::Owner> CommandBoard::Owners() const {
  const MutexLock lock(mutex_);
  std::vector<Owner> owners;
  owners.reserve(slots_.size());
  for (const Slot& slot : slots_) {
    owners.push_back({slot.robot, slot.owner, slot.owner_name.empty() ? slot.owner_peer : slot.owner_name,
                      slot.participates && !slot.dropped, slot.dropped});
  }
  return owners;
}

std::vector<Awaited> CommandBoard::Awaiting(Nanoseconds now, std::size_t max, std::size_t* total) const {
  const MutexLock lock(mutex_);
  std::vector<Awaited> awaiting;
  const bool waits = mode_ == Mode::kLockstep;
  if (total != nullptr) *total = waits ? awaited_ : 0;
  if (!waits || awaited_ == 0) return awaiting;
  for (const Slot& slot : slots_) {
    if (awaiting.size() >= max) break;
    if (!IsAwaited(slot)) continue;
    const std::string& who = slot.owner_name.empty() ? slot.owner_peer : slot.owner_name;
    awaiting.push_back({slot.robot, slot.owner == 0 ? "no client" : "no command from " + who,
                        ToSeconds(now - slot.waiting_since)});
  }
  return awaiting;
}

}  // namespace coopdyn
