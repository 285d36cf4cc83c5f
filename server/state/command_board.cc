// SPDX-License-Identifier: MIT
// The part of the board called by connections' threads. command_board_steps.cc has the stepping thread's.
#include "server/state/command_board.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

// --- permissions and ownership

std::optional<Verdict> CommandBoard::Objection(std::size_t index, const Client& client) const {
  if (stopping_) return Verdict{Error::kNotPossible, why_stopping_};
  if (playing_) return Verdict{Error::kNotPossible, kPlayingText};
  const Drive& drive = table_.drive(index);
  const std::string& robot = table_.slot(index).robot;
  if (drive.driven) {
    return Verdict{Error::kOwned, robot + " is owned by " + table_.Who(index) + ": release_robot " + robot +
                                      " of /simulation, or the page, unloads it"};
  }
  if (IsHeldBeside(index, client)) {
    return Owned(
        index,
        ": wait until that program ends, or free the robot (release_robot of /simulation, or the page)");
  }
  return std::nullopt;
}

void CommandBoard::TakeOwnership(std::size_t index, const Client& client) {
  Drive& drive = table_.drive(index);
  Slot& slot = table_.slot(index);
  if (client.has_ended()) {
    slot.former = client;
    return;
  }
  if (drive.owner != client.id) {
    drive.owner = client.id;
    slot.owner = client;
    slot.heard.reset();
    slot.former.id = 0;
    drive.loses_client = drive.abandoned = drive.silenced = false;
    if (client.is_team) NoteTeams();
  }
}

void CommandBoard::Disown(std::size_t index) {
  if (table_.slot(index).owner.is_team) NoteTeams();
  table_.drive(index).owner = 0;
  table_.drive(index).silenced = false;
  table_.slot(index).owner = {};
}

std::optional<Verdict> CommandBoard::TeamObjection(std::size_t index, const Client& client) const {
  if (!table_.drive(index).has_module) {
    return Verdict{Error::kNotPossible, table_.slot(index).robot + " has no actuators: it can only be read"};
  }
  return Objection(index, client);
}

// --- one robot

SlotId CommandBoard::FindSlot(const std::string& robot, const std::string& module) const {
  const MutexLock lock(mutex_);
  return table_.FindSlot(robot, module);
}

std::string CommandBoard::OwnerOf(SlotId slot) const {
  const MutexLock lock(mutex_);
  const std::size_t index = table_.Find(slot);
  return index == kNoSlot ? "" : table_.Who(index);
}

std::vector<SlotId> CommandBoard::FindSlots(const Scene& scene) const {
  const MutexLock lock(mutex_);
  std::vector<SlotId> slots;
  slots.reserve(scene.actuators.size());
  for (const SceneActuator& actuator : scene.actuators) {
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(actuator.robot)];
    slots.push_back(table_.FindSlot(robot.entry.name, actuator.module));
  }
  return slots;
}

Verdict CommandBoard::Command(SlotId id, const Client& client, std::span<const Setpoint> setpoints,
                              std::optional<int> steps, StepDone done) {
  return Insist([&] { return TryCommand(id, client, setpoints, steps, done); });
}

Verdict CommandBoard::TryCommand(SlotId id, const Client& client, std::span<const Setpoint> setpoints,
                                 std::optional<int> steps, StepDone& done) {
  Completions completions;
  Verdict verdict;
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    const std::size_t index = table_.Find(id);
    if (index == kNoSlot) return Gone();
    if (std::optional<Verdict> objection = Objection(index, client)) return *std::move(objection);
    completions = MakeCompletions();
    const bool was_awaited = table_.drive(index).is_awaited();
    const bool adds = client.IsAllyOf(table_.slot(index).owner) && table_.drive(index).owner != client.id;
    TakeOwnership(index, client);
    if (!adds) ReplacePending(index, client, completions);
    StepDone before = adds && table_.drive(index).pending ? std::move(table_.slot(index).done) : nullptr;
    table_.SetPending(index, client.id, setpoints, steps.value_or(1));
    verdict = Fine();
    verdict.answer_now = !steps.has_value() && mode_ != Mode::kLockstep;
    if (verdict.answer_now) done = nullptr;
    if (before && done) {
      done = [first = std::move(before), second = std::move(done)](const StepResult& result) {
        first(result);
        second(result);
      };
    } else if (before) {
      done = std::move(before);
    }
    table_.drive(index).has_done = done != nullptr;
    table_.slot(index).done = std::move(done);
    std::optional<Nanoseconds> now;
    became_ready = NoteChange(index, was_awaited, now);
  }
  completions.Call();
  if (became_ready && all_ready_hook_) all_ready_hook_();
  return verdict;
}

Verdict CommandBoard::Ready(SlotId slot, const Client& client, int steps, StepDone done) {
  if (WaitInPlayback(steps, done)) return {.answer_now = false};
  return Command(slot, client, {}, steps, std::move(done));
}

Verdict CommandBoard::Claim(SlotId id, const Client& client) {
  return Insist([&]() -> Verdict {
    const MutexLock lock(mutex_);
    const std::size_t index = table_.Find(id);
    if (index == kNoSlot) return Gone();
    if (std::optional<Verdict> objection = Objection(index, client)) return *std::move(objection);
    TakeOwnership(index, client);
    return Fine();
  });
}

Verdict CommandBoard::MayTune(SlotId id, const Client& client) {
  return Insist([&]() -> Verdict {
    const MutexLock lock(mutex_);
    const std::size_t index = table_.Find(id);
    if (index == kNoSlot) return Gone();
    return Objection(index, client).value_or(Fine());
  });
}

Verdict CommandBoard::Release(SlotId id, const Client& client) {
  return Insist([&]() -> Verdict {
    const MutexLock lock(mutex_);
    const std::size_t index = table_.Find(id);
    if (index == kNoSlot) return Gone();
    const ClientId owner = table_.drive(index).owner;
    if (owner == client.id) {
      Disown(index);
    } else if (owner != 0 || table_.drive(index).driven) {
      return NotOwner(index);
    }
    return Fine();
  });
}

Verdict CommandBoard::Hello(SlotId id, const Client& client) {
  const MutexLock lock(mutex_);
  Verdict verdict = Fine();
  const std::size_t index = table_.Find(id);
  if (index != kNoSlot) verdict.displaced = table_.TakeOver(index, client);
  return verdict;
}

Verdict CommandBoard::Send(SlotId id, const Client& client, const RobotMessage& message) {
  return Insist([&] { return TrySend(id, client, message); });
}

Verdict CommandBoard::TrySend(SlotId id, const Client& client, const RobotMessage& message) {
  const MutexLock lock(mutex_);
  const std::size_t found = table_.Find(id);
  if (found == kNoSlot) return Gone();
  if (stopping_) return Verdict{Error::kNotPossible, why_stopping_};
  if (playing_) return Verdict{Error::kNotPossible, kPlayingText};
  const std::size_t index = table_.first_slot(table_.drive(found).robot);
  Slot& slot = table_.slot(index);
  if (table_.drive(index).driven) {
    return Verdict{Error::kOwned, slot.robot + " is owned by " + table_.Who(index) +
                                      ", which sends for it: release_robot " + slot.robot +
                                      " of /simulation unloads it"};
  }
  const bool same_name = !slot.owner.name.empty() && slot.owner.name == client.name;
  if (table_.drive(index).owner != 0 && !same_name) {
    return Owned(index, slot.owner.name.empty()
                            ? ", which has no name: say hello NAME there and here, then it may send here, too"
                            : ": only a client of the same name (hello) may send for it");
  }
  if (slot.message == Slot::kNoMessage) {
    slot.message = static_cast<std::uint32_t>(messages_.size());
    messages_.push_back({table_.drive(index).robot, 0, message});
  } else {
    messages_[slot.message].message = message;
  }
  return Fine();
}

// --- many robots at once, for /swarm: one lock and one callback per batch

Verdict CommandBoard::StepAll(const TeamStep& step, const Client& client, int steps, StepDone done) {
  if (step.setpoints.empty() && WaitInPlayback(steps, done)) return {.answer_now = false};
  return Insist([&] { return TryStepAll(step, client, steps, done); });
}

Verdict CommandBoard::TryStepAll(const TeamStep& step, const Client& client, int steps, StepDone& done) {
  Completions completions;
  Verdict verdict;
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    for (const SlotId id : step.slots) {
      const std::size_t index = table_.Find(id);
      if (index == kNoSlot) return Gone();
      if (table_.drive(index).owner == client.id && !stopping_ && !playing_) continue;
      if (std::optional<Verdict> objection = TeamObjection(index, client)) return *std::move(objection);
    }
    completions = MakeCompletions();
    const std::uint64_t batch = next_batch_++;
    std::optional<Nanoseconds> now;
    Waiter waiter{batch, 0, steps, false, std::move(done), 0};
    const auto place = [&](std::size_t index, std::span<const Setpoint> setpoints) REQUIRES(mutex_) {
      const bool was_awaited = table_.drive(index).is_awaited();
      TakeOwnership(index, client);
      ReplacePending(index, client, completions);
      table_.SetPending(index, client.id, setpoints, steps);
      table_.drive(index).batch = batch;
      ++waiter.members;
      became_ready |= NoteChange(index, was_awaited, now);
    };
    std::span<const Setpoint> left = step.setpoints;
    for (const SlotId id : step.slots) {
      const std::size_t index = table_.Find(id),
                        count = std::min<std::size_t>(table_.drive(index).channel_count, left.size());
      place(index, left.first(count));
      left = left.subspan(count);
    }
    for (const SlotId id : step.others) {
      const std::size_t index = table_.Find(id);
      if (index != kNoSlot && table_.IsOf(index, client.id)) place(index, {});
    }
    waiters_.push_back(std::move(waiter));
    verdict = Fine();
    verdict.answer_now = false;
  }
  completions.Call();
  if (became_ready && all_ready_hook_) all_ready_hook_();
  return verdict;
}

Verdict CommandBoard::ClaimAll(std::span<const SlotId> slots, const Client& client) {
  return Insist([&]() -> Verdict {
    const MutexLock lock(mutex_);
    for (const SlotId id : slots) {
      const std::size_t index = table_.Find(id);
      if (index == kNoSlot) return Gone();
      if (std::optional<Verdict> objection = TeamObjection(index, client)) return *std::move(objection);
    }
    for (const SlotId id : slots) TakeOwnership(table_.Find(id), client);
    return Fine();
  });
}

Verdict CommandBoard::ClaimFree(const Client& client) {
  Verdict verdict;
  bool freed = true;
  while (std::exchange(freed, false)) {
    std::vector<Holder> holders;
    {
      const MutexLock lock(mutex_);
      verdict = Fine();
      for (std::size_t i = 0; i < table_.size(); ++i) {
        if (table_.drive(i).owner == 0 && !TeamObjection(i, client)) TakeOwnership(i, client);
        const bool is_same = !holders.empty() && holders.back().id == table_.drive(i).owner;
        if (IsHeldBeside(i, client) && !is_same) holders.push_back(HolderOf(i));
      }
    }
    for (const Holder& holder : holders) freed |= FreeIfEnded(holder);
  }
  return verdict;
}

Verdict CommandBoard::ReleaseAll(std::span<const SlotId> slots, const Client& client) {
  return Insist([&]() -> Verdict {
    const MutexLock lock(mutex_);
    for (const SlotId id : slots) {
      const std::size_t index = table_.Find(id);
      if (index == kNoSlot) return Gone();
      const Drive& drive = table_.drive(index);
      if (drive.owner == client.id || (drive.owner == 0 && !drive.driven)) continue;
      return NotOwner(index);
    }
    for (const SlotId id : slots) {
      const std::size_t index = table_.Find(id);
      if (table_.drive(index).owner == client.id) Disown(index);
      if (table_.slot(index).former.id == client.id) table_.slot(index).former.id = 0;
    }
    return Fine();
  });
}

void CommandBoard::StopTeam(std::span<const SlotId> slots, const Client& client) {
  const MutexLock lock(mutex_);
  for (const SlotId id : slots) {
    const std::size_t index = table_.Find(id);
    if (index != kNoSlot && table_.IsOf(index, client.id)) table_.StopPending(index);
  }
}

std::vector<ClientId> CommandBoard::HelloAll(const Client& client) {
  const MutexLock lock(mutex_);
  std::vector<ClientId> displaced;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const ClientId former = table_.TakeOver(i, client);
    if (former != 0 && std::ranges::find(displaced, former) == displaced.end()) displaced.push_back(former);
  }
  if (!displaced.empty()) NoteTeams();
  return displaced;
}

std::vector<SlotId> CommandBoard::Team(ClientId client) const {
  const MutexLock lock(mutex_);
  std::vector<SlotId> team;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_.IsOf(i, client)) team.push_back(table_.slot(i).id);
  }
  return team;
}

// --- waiting, watching

bool CommandBoard::WaitInPlayback(int steps, StepDone& done) {
  const MutexLock lock(mutex_);
  if (!playing_ || stopping_) return false;
  waiters_.push_back({0, 0, steps, false, std::move(done), 0});
  return true;
}

void CommandBoard::WaitSteps(std::int64_t steps, StepDone done, std::int64_t asked) {
  std::string why;
  {
    const MutexLock lock(mutex_);
    if (!stopping_) {
      waiters_.push_back({0, 0, steps, false, std::move(done), asked});
      return;
    }
    why = why_stopping_;
  }
  done({StepEnd::kStopping, nullptr, Mode::kRealtime, 0, 0, std::move(why)});
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
  for (std::size_t robot = 0; robot < table_.robot_count(); ++robot) {
    const std::size_t first = table_.first_slot(robot), end = table_.first_slot(robot + 1);
    std::size_t shown = first;
    while (shown + 1 < end && table_.drive(shown).owner == 0) ++shown;
    if (table_.drive(shown).owner == 0) shown = first;
    const Drive& drive = table_.drive(shown);
    Owner owner{table_.slot(shown).robot, drive.owner, table_.Who(shown)};
    owner.is_team = table_.slot(shown).owner.is_team;
    owner.driven = drive.driven;
    if (is_real_time() && drive.owner != 0 && !playing_) owner.heard = table_.slot(shown).heard;
    if (owner.heard) owner.heard = std::max(*owner.heard, silence_from_);
    for (std::size_t i = first; i < end; ++i) {
      const Drive& each = table_.drive(i);
      owner.participates |= each.participates && !each.dropped;
      owner.dropped |= each.dropped;
      owner.silenced |= each.silenced;
      owner.still_moving |= each.owner == 0 && !each.driven && !playing_ && table_.Moves(i);
    }
    owners.push_back(std::move(owner));
  }
  return owners;
}

std::vector<Awaited> CommandBoard::Awaiting(Nanoseconds now, std::size_t max, std::size_t* total) const {
  const MutexLock lock(mutex_);
  std::vector<Awaited> awaiting;
  const bool waits = mode_ == Mode::kLockstep;
  if (total != nullptr) *total = waits ? awaited_ : 0;
  if (!waits) return awaiting;
  for (const std::string& program : programs_) {
    const std::string lack = LackOf(program);
    if (lack.empty()) continue;
    if (total != nullptr) ++*total;
    if (awaiting.size() < max) awaiting.push_back({program, lack, ToSeconds(now - waiting_since_)});
  }
  if (awaited_ == 0) return awaiting;
  std::string cure;
  for (std::size_t i = 0; i < table_.size() && awaiting.size() < max; ++i) {
    if (!table_.drive(i).is_awaited()) continue;
    const bool no_client = table_.drive(i).owner == 0;
    if (no_client && cure.empty()) cure = table_.CureForNoClient();
    awaiting.push_back({table_.NameOf(i), no_client ? "no client" : "no command from " + table_.Who(i),
                        ToSeconds(now - waiting_since_), no_client ? cure : ""});
  }
  return awaiting;
}

}  // namespace coopdyn
