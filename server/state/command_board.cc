// SPDX-License-Identifier: MIT
// The part of the board that robots' threads call, for one robot at a time. command_board_team.cc has the
// calls for many, command_board_steps.cc those of the stepping thread.
#include "server/state/command_board.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

// --- what all parts use
// -------------------------------------------------------------------------------------

std::size_t CommandBoard::Find(SlotId id) const {
  return id < slot_index_.size() ? slot_index_[id] : kNoSlot;
}

std::string CommandBoard::Who(std::size_t index) const {
  const Slot& slot = slots_[index];
  if (drives_[index].driven) return "controller " + slot.controller;
  return slot.owner.shown();
}

std::string CommandBoard::NameOf(std::size_t index) const {
  const std::size_t robot = drives_[index].robot;
  const bool several = first_slots_[robot + 1] - first_slots_[robot] > 1;
  return several ? slots_[index].robot + "/" + slots_[index].module : slots_[index].robot;
}

bool CommandBoard::Drives(std::size_t index) const {
  const auto first = in_force_.begin() + drives_[index].first_channel;
  return std::any_of(first, first + drives_[index].channel_count,
                     [](const Setpoint& setpoint) { return setpoint.drives(); });
}

void CommandBoard::Stop(std::size_t index) {
  for (Setpoint& setpoint : Of(index, in_force_)) setpoint = setpoint.stopped();
}

void CommandBoard::StopPending(std::size_t index) {
  Stop(index);
  Drive& drive = drives_[index];
  if (!drive.pending) return;
  if (!drive.has_setpoint) std::ranges::copy(Of(index, in_force_), Of(index, commanded_).begin());
  for (Setpoint& setpoint : Of(index, commanded_)) setpoint = setpoint.stopped();
  drive.has_setpoint = true;
}

bool CommandBoard::NoteChange(std::size_t index, bool was_awaited) {
  const bool is_awaited = IsAwaited(drives_[index]);
  if (was_awaited == is_awaited) return false;
  awaited_ += is_awaited ? 1 : -1;
  return awaited_ == 0 && mode_ == Mode::kLockstep;
}

void CommandBoard::Completions::Call() const {
  StepResult result{StepEnd::kRan, frame, mode};
  for (const auto& [done, end] : calls) {
    result.end = end;
    done(result);
  }
}

std::optional<Verdict> CommandBoard::Objection(std::size_t index, const Client& client) const {
  if (stopping_) return Verdict{Error::kNotPossible, "the daemon is stopping"};
  if (playing_) return Verdict{Error::kNotPossible, kPlayingText};
  const Drive& drive = drives_[index];
  const std::string& robot = slots_[index].robot;
  if (drive.driven) {
    return Verdict{Error::kOwned, robot + " is owned by " + Who(index) + ": release_robot " + robot +
                                      " of /simulation, or the page, unloads it"};
  }
  if (drive.owner != 0 && drive.owner != client.id) {
    return Verdict{Error::kOwned, robot + " is driven by " + Who(index) +
                                      ": wait until that program ends, or free the robot (release_robot of "
                                      "/simulation, or the page)"};
  }
  return std::nullopt;
}

void CommandBoard::TakeOwnership(std::size_t index, const Client& client) {
  Drive& drive = drives_[index];
  Slot& slot = slots_[index];
  if (client.input_ended) {
    slot.former = client;
    return;
  }
  if (drive.owner != client.id) {
    drive.owner = client.id;
    slot.owner = client;
    slot.former.id = 0;
    drive.loses_client = drive.abandoned = false;
    if (client.is_team) NoteTeams();
  }
}

void CommandBoard::Disown(std::size_t index) {
  if (slots_[index].owner.is_team) NoteTeams();
  drives_[index].owner = 0;
  slots_[index].owner = {};
}

void CommandBoard::ClearPending(std::size_t index) {
  Drive& drive = drives_[index];
  drive.pending = drive.has_setpoint = drive.latched = false;
  drive.pending_from = 0;
  drive.batch = 0;
  drive.steps_left = 0;
  if (drive.has_done) slots_[index].done = nullptr;
  drive.has_done = false;
}

void CommandBoard::ReplacePending(std::size_t index, const Client& client, Completions& completions) {
  Drive& drive = drives_[index];
  if (!drive.pending || drive.pending_from == client.id) return;
  if (drive.has_done) completions.calls.emplace_back(std::move(slots_[index].done), StepEnd::kReplaced);
  if (drive.batch != 0) {
    const auto waiter = std::find_if(waiters_.begin(), waiters_.end(), [&drive](const Waiter& candidate) {
      return candidate.batch == drive.batch;
    });
    if (waiter != waiters_.end() && --waiter->members == 0) {
      completions.calls.emplace_back(std::move(waiter->done), StepEnd::kReplaced);
      waiters_.erase(waiter);
    }
  }
  ClearPending(index);
}

void CommandBoard::SetPending(std::size_t index, const Client& client, std::span<const Setpoint> setpoints,
                              int steps) {
  Drive& drive = drives_[index];
  drive.excused = drive.dropped = drive.abandoned = false;
  if (!setpoints.empty()) {
    std::ranges::copy(setpoints, Of(index, commanded_).begin());
    drive.has_setpoint = true;
  } else if (!drive.pending) {
    drive.has_setpoint = false;
  }
  drive.pending = true;
  drive.latched = false;  // a step that runs now did not see it
  drive.pending_from = client.id;
  drive.batch = 0;
  drive.steps_left = steps;
}

void CommandBoard::ApplyPolicy(std::size_t index, LossPolicy policy) {
  Drive& drive = drives_[index];
  switch (policy) {
    case LossPolicy::kWait:
      return;
    case LossPolicy::kHold:
      drive.excused = true;
      return;
    case LossPolicy::kStop:
      Stop(index);
      drive.excused = true;
      return;
    case LossPolicy::kDrop:
      Stop(index);
      drive.dropped = true;
      return;
  }
}

void CommandBoard::EndInput(std::size_t index) {
  slots_[index].former = slots_[index].owner;
  Disown(index);
}

void CommandBoard::LoseClient(std::size_t index) {
  if (drives_[index].owner != 0) EndInput(index);
  slots_[index].former.id = 0;
  if (drives_[index].pending) {
    drives_[index].loses_client = true;
  } else {
    ApplyLoss(index);
  }
}

void CommandBoard::ApplyLoss(std::size_t index) {
  const Slot& slot = slots_[index];
  if (slot.on_disconnect) {
    ApplyPolicy(index, *slot.on_disconnect);
    if (*slot.on_disconnect != LossPolicy::kWait) NoteLoss(index, *slot.on_disconnect);
  } else if (!slot.former.name.empty()) {
    drives_[index].abandoned = true;
    if (mode_ != Mode::kLockstep) StopAbandoned(index);
  }
}

void CommandBoard::StopAbandoned(std::size_t index) {
  drives_[index].abandoned = false;
  if (!Drives(index)) return;
  Stop(index);
  NoteLoss(index, LossPolicy::kStop);
}

void CommandBoard::NoteLoss(std::size_t index, LossPolicy policy) {
  losses_.push_back({drives_[index].robot, slots_[index].former.shown(), policy});
}

// --- one robot
// ----------------------------------------------------------------------------------------------

SlotId CommandBoard::SlotOf(const std::string& robot, const std::string& module) const {
  const auto found = by_name_.find(robot);
  if (found == by_name_.end()) return 0;
  const std::size_t first = first_slots_[found->second];
  for (std::size_t i = first; !module.empty() && i < first_slots_[found->second + 1]; ++i) {
    if (slots_[i].module == module) return slots_[i].id;
  }
  return slots_[first].id;
}

SlotId CommandBoard::FindSlot(const std::string& robot, const std::string& module) const {
  const MutexLock lock(mutex_);
  return SlotOf(robot, module);
}

std::string CommandBoard::OwnerOf(SlotId slot) const {
  const MutexLock lock(mutex_);
  const std::size_t index = Find(slot);
  return index == kNoSlot ? "" : Who(index);
}

std::vector<SlotId> CommandBoard::FindSlots(const Scene& scene) const {
  const MutexLock lock(mutex_);
  std::vector<SlotId> slots;
  slots.reserve(scene.robots.size());
  for (const SceneRobot& robot : scene.robots) {
    const ActuatorModel* drive = robot.entry.model->drive_actuator();
    slots.push_back(SlotOf(robot.entry.name, drive == nullptr ? "" : drive->module));
  }
  return slots;
}

Verdict CommandBoard::Command(SlotId id, const Client& client, std::span<const Setpoint> setpoints,
                              std::optional<int> steps, StepDone done) {
  Completions completions;
  Verdict verdict;
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    const std::size_t index = Find(id);
    if (index == kNoSlot) return Gone();
    if (std::optional<Verdict> objection = Objection(index, client)) return *std::move(objection);
    completions = MakeCompletions();
    const bool was_awaited = IsAwaited(drives_[index]);
    TakeOwnership(index, client);
    ReplacePending(index, client, completions);
    SetPending(index, client, setpoints, steps.value_or(1));
    verdict = Fine();
    verdict.answer_now = !steps.has_value() && mode_ != Mode::kLockstep;
    drives_[index].has_done = !verdict.answer_now;
    slots_[index].done = verdict.answer_now ? nullptr : std::move(done);
    became_ready = NoteChange(index, was_awaited);
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
  const MutexLock lock(mutex_);
  const std::size_t index = Find(id);
  if (index == kNoSlot) return Gone();
  if (std::optional<Verdict> objection = Objection(index, client)) return *std::move(objection);
  TakeOwnership(index, client);
  return Fine();
}

Verdict CommandBoard::Release(SlotId id, const Client& client) {
  const MutexLock lock(mutex_);
  const std::size_t index = Find(id);
  if (index == kNoSlot) return Gone();
  const ClientId owner = drives_[index].owner;
  if (owner == client.id) {
    Disown(index);
  } else if (owner != 0 || drives_[index].driven) {
    return NotOwner(index);
  }
  return Fine();
}

Verdict CommandBoard::Hello(SlotId id, const Client& client) {
  const MutexLock lock(mutex_);
  Verdict verdict = Fine();
  const std::size_t index = Find(id);
  if (index == kNoSlot || drives_[index].owner == 0) return verdict;
  Drive& drive = drives_[index];
  Slot& slot = slots_[index];
  if (drive.owner == client.id) {
    slot.owner.name = client.name;
  } else if (!client.name.empty() && slot.owner.name == client.name && slot.owner.is_team == client.is_team) {
    verdict.displaced = std::exchange(drive.owner, client.id);
    slot.owner = client;
  }
  return verdict;
}

void CommandBoard::InputEnded(SlotId id, ClientId client) {
  const MutexLock lock(mutex_);
  const std::size_t index = Find(id);
  if (index == kNoSlot || drives_[index].owner != client) return;
  EndInput(index);
}

void CommandBoard::Closed(SlotId id, ClientId client) {
  bool became_ready = false;
  {
    const MutexLock lock(mutex_);
    const std::size_t index = Find(id);
    if (index == kNoSlot) return;
    const ClientId owner = drives_[index].owner;
    const bool was_former = owner == 0 && slots_[index].former.id == client;
    if (owner != client && !was_former) return;
    const bool was_awaited = IsAwaited(drives_[index]);
    LoseClient(index);
    became_ready = NoteChange(index, was_awaited);
  }
  if (became_ready && all_ready_hook_) all_ready_hook_();
}

Verdict CommandBoard::Send(SlotId id, const Client& client, const RobotMessage& message) {
  const MutexLock lock(mutex_);
  const std::size_t found = Find(id);
  if (found == kNoSlot) return Gone();
  if (stopping_) return Verdict{Error::kNotPossible, "the daemon is stopping"};
  if (playing_) return Verdict{Error::kNotPossible, kPlayingText};
  const std::size_t index = first_slots_[drives_[found].robot];
  Slot& slot = slots_[index];
  if (drives_[index].driven) {
    return Verdict{Error::kOwned, slot.robot + " is owned by " + Who(index) + ", which sends for it: " +
                                      "release_robot " + slot.robot + " of /simulation unloads it"};
  }
  const bool same_name = !slot.owner.name.empty() && slot.owner.name == client.name;
  if (drives_[index].owner != 0 && !same_name) {
    return Verdict{Error::kOwned, slot.robot + " is driven by " + Who(index) +
                                      (slot.owner.name.empty()
                                           ? ", which has no name: say hello NAME there and here, then it "
                                             "may send here, too"
                                           : ": only a client of the same name (hello) may send for it")};
  }
  if (slot.message == kNoMessage) {
    slot.message = static_cast<std::uint32_t>(messages_.size());
    messages_.push_back({drives_[index].robot, 0, message});
  } else {
    messages_[slot.message].message = message;
  }
  return Fine();
}

// --- waiting, watching
// --------------------------------------------------------------------------------------

bool CommandBoard::WaitInPlayback(int steps, StepDone& done) {
  const MutexLock lock(mutex_);
  if (!playing_ || stopping_) return false;
  waiters_.push_back({0, 0, steps, false, std::move(done), 0});
  return true;
}

void CommandBoard::WaitSteps(std::int64_t steps, StepDone done, std::int64_t asked) {
  {
    const MutexLock lock(mutex_);
    if (!stopping_) {
      waiters_.push_back({0, 0, steps, false, std::move(done), asked});
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
  for (std::size_t robot = 0; robot + 1 < first_slots_.size(); ++robot) {
    const std::size_t first = first_slots_[robot], end = first_slots_[robot + 1];
    std::size_t shown = first;
    while (shown + 1 < end && drives_[shown].owner == 0) ++shown;
    if (drives_[shown].owner == 0) shown = first;
    const Drive& drive = drives_[shown];
    Owner owner{slots_[shown].robot, drive.owner, Who(shown)};
    owner.is_team = slots_[shown].owner.is_team;
    owner.driven = drive.driven;
    for (std::size_t i = first; i < end; ++i) {
      owner.participates |= drives_[i].participates && !drives_[i].dropped;
      owner.dropped |= drives_[i].dropped;
      owner.still_moving |= drives_[i].owner == 0 && !drives_[i].driven && !playing_ && Drives(i);
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
  if (!waits || awaited_ == 0) return awaiting;
  std::string cure;
  for (std::size_t i = 0; i < slots_.size() && awaiting.size() < max; ++i) {
    if (!IsAwaited(drives_[i])) continue;
    const bool no_client = drives_[i].owner == 0;
    if (no_client && cure.empty()) cure = CureForNoClient();
    awaiting.push_back({NameOf(i), no_client ? "no client" : "no command from " + Who(i),
                        ToSeconds(now - waiting_since_), no_client ? cure : ""});
  }
  return awaiting;
}

std::string CommandBoard::CureForNoClient() const {
  const bool several = std::count_if(drives_.begin(), drives_.end(), [](const Drive& drive) {
                         return IsAwaited(drive) && drive.owner == 0;
                       }) > 1;
  constexpr std::size_t kNamed = 4;
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < drives_.size() && count <= kNamed; ++i) {
    if (drives_[i].owner == 0) continue;
    if (++count <= kNamed) names += " " + slots_[i].robot;
  }
  const std::string start = several ? "start their programs" : "start its program";
  if (count == 0) return start + ", or set_mode realtime";
  const std::string others = count <= kNamed ? names : " and the names of the robots that have one";
  return start + ", or let the others go on with set_participants" + others +
         ", or the page's button 'connected'";
}

}  // namespace coopdyn
