// SPDX-License-Identifier: MIT
// The part of the board that the stepping thread calls.
#include <algorithm>
#include <limits>
#include <utility>

#include "server/state/command_board.h"

namespace coopdyn {

namespace {

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

Nanoseconds DeadlineOf(double deadline_s, Nanoseconds waiting_since) {
  return waiting_since + static_cast<Nanoseconds>(deadline_s * 1e9);
}

}  // namespace

void CommandBoard::EndAllWaits(StepEnd end, Completions& completions) {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i].has_done) completions.calls.emplace_back(std::move(slots_[i].done), end);
    ClearPending(i);
  }
  for (Waiter& waiter : waiters_) completions.calls.emplace_back(std::move(waiter.done), end);
  waiters_.clear();
}

void CommandBoard::CountAwaited() {
  awaited_ = static_cast<std::size_t>(std::count_if(drives_.begin(), drives_.end(), IsAwaited));
}

void CommandBoard::ClearMessages() {
  for (const SentMessage& sent : messages_) slots_[first_slots_[sent.robot]].message = kNoMessage;
  messages_.clear();
}

void CommandBoard::Configure(const Scene& scene, StepEnd end, FramePtr frame, Nanoseconds now) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    last_frame_ = std::move(frame);
    completions = MakeCompletions();
    EndAllWaits(end, completions);
    messages_.clear();
    const std::vector<Slot> old = std::exchange(slots_, {});
    const std::vector<Drive> old_drives = std::exchange(drives_, {});
    const auto old_names = std::exchange(by_name_, {});
    const std::vector<std::size_t> old_first = std::exchange(first_slots_, {});
    slots_.reserve(scene.actuators.size());
    drives_.reserve(scene.actuators.size());
    has_deadlines_ = false;
    for (const SceneActuator& actuator : scene.actuators) {
      Slot slot;
      Drive drive;
      const auto robot = static_cast<std::size_t>(actuator.robot);
      const RobotEntry& entry = scene.robots[robot].entry;
      const std::vector<std::string> awaited = entry.awaited_modules();
      const bool is_awaited = std::ranges::find(awaited, actuator.module) != awaited.end();
      slot.robot = entry.name;
      slot.type = entry.model->type;
      slot.module = actuator.module;
      drive.robot = static_cast<std::uint32_t>(robot);
      drive.first_channel = static_cast<std::uint32_t>(actuator.first_channel);
      drive.channel_count = static_cast<std::uint32_t>(actuator.channel_count);
      slot.controller = entry.controller.name;
      slot.deadline_s = entry.deadline_s;
      slot.on_deadline = entry.on_deadline;
      slot.on_disconnect = entry.on_disconnect;
      slot.participates_by_scene = entry.participates() && is_awaited;
      slot.may_participate = entry.sync && is_awaited;
      slot.is_awaited = is_awaited;
      drive.has_module = !actuator.module.empty();
      drive.driven = !entry.controller.empty();
      drive.participates = slot.participates_by_scene;
      has_deadlines_ |= slot.deadline_s.has_value();
      if (first_slots_.size() == robot) first_slots_.push_back(slots_.size());
      const auto named = old_names.find(slot.robot);
      const std::size_t before =
          named == old_names.end() ? kNoSlot : old_first[named->second] + slots_.size() - first_slots_.back();
      if (before < old.size() && old[before].robot == slot.robot && old[before].type == slot.type &&
          old[before].module == slot.module) {
        const Slot& same = old[before];
        slot.id = same.id;
        if (!drive.driven) {
          drive.owner = old_drives[before].owner;
          slot.owner = same.owner;
          slot.former = same.former;
          if (end == StepEnd::kReset) drive.participates = old_drives[before].participates;
        }
      } else {
        slot.id = next_slot_++;
      }
      by_name_.emplace(slot.robot, robot);
      slots_.push_back(std::move(slot));
      drives_.push_back(drive);
    }
    first_slots_.push_back(slots_.size());
    in_force_.assign(scene.channels.size(), {});
    commanded_ = in_force_;
    latched_ = in_force_;
    slot_index_.assign(next_slot_, kNoSlot);
    for (std::size_t i = 0; i < slots_.size(); ++i) slot_index_[slots_[i].id] = i;
    latched_commands_.assign(slots_.size(), 0);
    latched_messages_.clear();
    losses_.clear();
    latched_losses_.clear();
    waiting_since_ = now;
    CountAwaited();
    NoteTeams();
    layout_revision_.fetch_add(1, std::memory_order_release);
  }
  completions.Call();
}

void CommandBoard::SetMode(Mode mode, Nanoseconds now) {
  const MutexLock lock(mutex_);
  mode_ = mode;
  waiting_since_ = now;
  if (mode == Mode::kLockstep) return;
  // Lockstep waited for their programs; now they would drive on without.
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i].abandoned) StopAbandoned(i);
  }
}

Mode CommandBoard::mode() const {
  const MutexLock lock(mutex_);
  return mode_;
}

std::string CommandBoard::NamesOfRobots() const {
  constexpr std::size_t kNamed = 8;
  const std::size_t robots = by_name_.size();
  std::string names = "there are";
  for (std::size_t i = 0; i < std::min(kNamed, robots); ++i) {
    names += (i == 0 ? " " : ", ") + slots_[first_slots_[i]].robot;
  }
  if (robots > kNamed) names += " and " + std::to_string(robots - kNamed) + " more (list shows all)";
  return slots_.empty() ? "there are no robots" : names;
}

Verdict CommandBoard::SetParticipants(std::span<const std::string> names, Nanoseconds now) {
  const MutexLock lock(mutex_);
  std::vector<bool> chosen(by_name_.size(), false);
  for (const std::string& name : names) {
    const auto found = by_name_.find(name);
    if (found == by_name_.end()) {
      return {Error::kNoSuchName, "no robot is called " + name + ": " + NamesOfRobots()};
    }
    const std::size_t first = first_slots_[found->second];
    const Drive& drive = drives_[first];
    if (drive.driven || !drive.has_module) {
      const std::string why = drive.driven ? " is driven by " + Who(first) : " has no actuators";
      return {Error::kNotPossible, name + why + ": only robots that clients drive can be waited for"};
    }
    chosen[found->second] = true;
  }
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Drive& drive = drives_[i];
    const bool by_scene = drive.driven ? false : slots_[i].participates_by_scene;
    drive.participates = names.empty() ? by_scene : chosen[drive.robot] && slots_[i].is_awaited;
    drive.dropped = false;
  }
  waiting_since_ = now;
  CountAwaited();
  return Fine();
}

void CommandBoard::SetDriven(std::size_t robot, const std::string& name, Nanoseconds now) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    if (robot + 1 >= first_slots_.size()) return;
    completions = MakeCompletions();
    for (std::size_t i = first_slots_[robot]; i < first_slots_[robot + 1]; ++i) {
      ReplacePending(i, Client{}, completions);
      Disown(i);
      Drive& drive = drives_[i];
      Slot& slot = slots_[i];
      Stop(i);
      drive.excused = drive.dropped = drive.loses_client = drive.abandoned = false;
      drive.driven = !name.empty();
      drive.participates = !drive.driven && slot.may_participate;
      slot.participates_by_scene = drive.participates;
      slot.controller = name;
      slot.former.id = 0;
    }
    waiting_since_ = now;
    CountAwaited();
  }
  completions.Call();
}

void CommandBoard::SetInForce(std::span<const Setpoint> setpoints) {
  const MutexLock lock(mutex_);
  if (setpoints.size() == in_force_.size()) std::ranges::copy(setpoints, in_force_.begin());
}

std::vector<Setpoint> CommandBoard::InForce() const {
  const MutexLock lock(mutex_);
  return in_force_;
}

void CommandBoard::SetPlaying(bool playing) {
  const MutexLock lock(mutex_);
  playing_ = playing;
}

void CommandBoard::EndSteps() {
  std::vector<std::pair<StepDone, StepResult>> ended;
  {
    const MutexLock lock(mutex_);
    std::erase_if(waiters_, [&](Waiter& waiter) REQUIRES(mutex_) {
      if (waiter.asked == 0) return false;
      const std::int64_t ran = waiter.asked - std::min(waiter.asked, waiter.steps_left);
      ended.emplace_back(std::move(waiter.done),
                         StepResult{StepEnd::kPaused, last_frame_, mode_, ran, waiter.asked});
      return true;
    });
  }
  for (const auto& [done, result] : ended) done(result);
}

void CommandBoard::StopAll() {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < drives_.size(); ++i) StopPending(i);
  ClearMessages();
}

bool CommandBoard::AllReady() const {
  const MutexLock lock(mutex_);
  return awaited_ == 0;
}

std::span<Setpoint> CommandBoard::Latch(std::uint64_t step) {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    Drive& drive = drives_[i];
    latched_commands_[i] = static_cast<std::uint8_t>(drive.pending && drive.has_setpoint && !drive.latched);
    if (drive.pending) {
      if (drive.has_setpoint) std::ranges::copy(Of(i, commanded_), Of(i, in_force_).begin());
      drive.latched = true;
    }
  }
  std::ranges::copy(in_force_, latched_.begin());
  for (Waiter& waiter : waiters_) waiter.latched = true;
  latched_messages_.clear();
  if (!messages_.empty()) {
    latched_messages_ = messages_;
    ClearMessages();
    // By robot, so that the order in which they arrived makes no difference.
    std::sort(latched_messages_.begin(), latched_messages_.end(),
              [](const SentMessage& a, const SentMessage& b) { return a.robot < b.robot; });
    for (SentMessage& sent : latched_messages_) sent.step = step;
  }
  latched_losses_.clear();
  latched_losses_.swap(losses_);
  return latched_;
}

void CommandBoard::FinishStep(const FramePtr& frame, Nanoseconds now) {
  std::vector<std::shared_ptr<const StepObserver>> observers;
  Completions completions;
  {
    const MutexLock lock(mutex_);
    last_frame_ = frame;
    waiting_since_ = now;
    observers.reserve(observers_.size());
    for (const Observer& observer : observers_) observers.push_back(observer.call);
    completions = MakeCompletions();
    completions.calls.reserve(calls_at_once_);
    awaited_ = 0;
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      Drive& drive = drives_[i];
      if (drive.pending && drive.latched && --drive.steps_left <= 0) {
        if (drive.has_done) completions.calls.emplace_back(std::move(slots_[i].done), StepEnd::kRan);
        ClearPending(i);
        if (std::exchange(drive.loses_client, false)) ApplyLoss(i);
      }
      if (IsAwaited(drive)) ++awaited_;
    }
    std::size_t kept = 0;
    for (Waiter& waiter : waiters_) {
      if (waiter.latched && --waiter.steps_left <= 0) {
        completions.calls.emplace_back(std::move(waiter.done), StepEnd::kRan);
      } else {
        if (&waiters_[kept] != &waiter) waiters_[kept] = std::move(waiter);
        ++kept;
      }
    }
    waiters_.resize(kept);
    calls_at_once_ = std::max(calls_at_once_, completions.calls.size());
  }
  for (const auto& observer : observers) (*observer)(frame);
  completions.Call();
}

void CommandBoard::RestartWaiting(Nanoseconds now) {
  const MutexLock lock(mutex_);
  waiting_since_ = now;
}

std::vector<FiredDeadline> CommandBoard::FireDeadlines(Nanoseconds now) {
  const MutexLock lock(mutex_);
  std::vector<FiredDeadline> fired;
  if (awaited_ == 0 || !has_deadlines_) return fired;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Slot& slot = slots_[i];
    if (!IsAwaited(drives_[i]) || !slot.deadline_s || now < DeadlineOf(*slot.deadline_s, waiting_since_))
      continue;
    ApplyPolicy(i, slot.on_deadline);
    if (fired.empty() || fired.back().robot != slot.robot) fired.push_back({slot.robot, slot.on_deadline});
  }
  CountAwaited();
  return fired;
}

Nanoseconds CommandBoard::NextDeadline() const {
  const MutexLock lock(mutex_);
  Nanoseconds next = kNever;
  if (awaited_ == 0 || !has_deadlines_) return next;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (IsAwaited(drives_[i]) && slots_[i].deadline_s)
      next = std::min(next, DeadlineOf(*slots_[i].deadline_s, waiting_since_));
  }
  return next;
}

void CommandBoard::Stop(FramePtr frame) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    last_frame_ = std::move(frame);
    completions = MakeCompletions();
    EndAllWaits(StepEnd::kStopping, completions);
    CountAwaited();
  }
  completions.Call();
}

}  // namespace coopdyn
