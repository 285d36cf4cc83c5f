// SPDX-License-Identifier: MIT
// The part of the board that the stepping thread calls.
#include <algorithm>
#include <limits>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/state/command_board.h"

namespace coopdyn {

namespace {

constexpr std::size_t kNoSlot = static_cast<std::size_t>(-1);
constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

Nanoseconds DeadlineOf(double deadline_s, Nanoseconds waiting_since) {
  return waiting_since + static_cast<Nanoseconds>(deadline_s * 1e9);
}

}  // namespace

void CommandBoard::EndAllWaits(StepEnd end, const FramePtr& frame, Completions& completions) {
  for (Slot& slot : slots_) {
    if (slot.pending.done)
      completions.emplace_back(std::move(slot.pending.done), StepResult{end, frame, mode_});
    slot.pending = {};
  }
  for (Waiter& waiter : waiters_)
    completions.emplace_back(std::move(waiter.done), StepResult{end, frame, mode_});
  waiters_.clear();
}

void CommandBoard::CountAwaited() {
  awaited_ = static_cast<std::size_t>(std::count_if(
      slots_.begin(), slots_.end(), [this](const Slot& slot) REQUIRES(mutex_) { return IsAwaited(slot); }));
}

void CommandBoard::Configure(const Scene& scene, StepEnd end, FramePtr frame, Nanoseconds now) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    EndAllWaits(end, frame, completions);
    last_frame_ = std::move(frame);
    std::vector<Slot> old = std::exchange(slots_, {});
    slots_.reserve(scene.robots.size());
    std::unordered_map<std::string_view, Slot*> kept;
    for (Slot& slot : old) kept.emplace(slot.robot, &slot);
    for (const SceneRobot& robot : scene.robots) {
      Slot slot;
      slot.robot = robot.entry.name;
      slot.type = robot.entry.model->type;
      slot.deadline_s = robot.entry.deadline_s;
      slot.on_deadline = robot.entry.on_deadline;
      slot.on_disconnect = robot.entry.on_disconnect;
      slot.participates_by_scene = robot.entry.participates();
      slot.participates = slot.participates_by_scene;
      slot.waiting_since = now;
      const auto before = kept.find(slot.robot);
      if (before != kept.end() && before->second->type == slot.type) {
        const Slot& same = *before->second;
        slot.id = same.id;
        slot.owner = same.owner;
        slot.owner_name = same.owner_name;
        slot.owner_peer = same.owner_peer;
        slot.former = same.former;
        if (end == StepEnd::kReset) slot.participates = same.participates;
      } else {
        slot.id = next_slot_++;
      }
      slots_.push_back(std::move(slot));
    }
    slot_index_.assign(next_slot_, kNoSlot);
    for (std::size_t i = 0; i < slots_.size(); ++i) slot_index_[slots_[i].id] = i;
    latched_.assign(slots_.size(), Setpoint{});
    CountAwaited();
  }
  Call(completions);
}

void CommandBoard::SetMode(Mode mode, Nanoseconds now) {
  const MutexLock lock(mutex_);
  mode_ = mode;
  for (Slot& slot : slots_) slot.waiting_since = now;
}

Mode CommandBoard::mode() const {
  const MutexLock lock(mutex_);
  return mode_;
}

Verdict CommandBoard::SetParticipants(std::span<const std::string> names, Nanoseconds now) {
  const MutexLock lock(mutex_);
  std::vector<bool> chosen(slots_.size(), false);
  for (const std::string& name : names) {
    const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                   [&](const Slot& candidate) { return candidate.robot == name; });
    if (slot == slots_.end()) {
      return {Error::kNoSuchName, "no robot is called " + name + ": list shows the names", true, mode_, 0};
    }
    chosen[static_cast<std::size_t>(slot - slots_.begin())] = true;
  }
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].participates = names.empty() ? slots_[i].participates_by_scene : chosen[i];
    slots_[i].dropped = false;
    slots_[i].waiting_since = now;
  }
  CountAwaited();
  return {Error::kOk, {}, true, mode_, 0};
}

void CommandBoard::StopAll() {
  const MutexLock lock(mutex_);
  for (Slot& slot : slots_) {
    slot.in_force = {};
    if (slot.pending.active) slot.pending.setpoint = Setpoint{};
  }
}

bool CommandBoard::AllReady() const {
  const MutexLock lock(mutex_);
  return awaited_ == 0;
}

std::span<const Setpoint> CommandBoard::Latch() {
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.pending.active && slot.pending.setpoint) slot.in_force = *slot.pending.setpoint;
    slot.pending.latched = slot.pending.active;
    latched_[i] = slot.in_force;
  }
  for (Waiter& waiter : waiters_) waiter.latched = true;
  return latched_;
}

void CommandBoard::FinishStep(const FramePtr& frame, Nanoseconds now) {
  std::vector<std::shared_ptr<const StepObserver>> observers;
  Completions completions;
  {
    const MutexLock lock(mutex_);
    last_frame_ = frame;
    observers.reserve(observers_.size());
    for (const Observer& observer : observers_) observers.push_back(observer.call);
    const StepResult result{StepEnd::kRan, frame, mode_};
    for (Slot& slot : slots_) {
      Pending& pending = slot.pending;
      slot.waiting_since = now;
      if (!pending.active || !pending.latched || --pending.steps_left > 0) continue;
      if (pending.done) completions.emplace_back(std::move(pending.done), result);
      pending = {};
      if (slot.after_pending) ApplyPolicy(slot, *std::exchange(slot.after_pending, std::nullopt));
    }
    std::size_t kept = 0;
    for (Waiter& waiter : waiters_) {
      if (waiter.latched && --waiter.steps_left <= 0) {
        completions.emplace_back(std::move(waiter.done), result);
      } else {
        if (&waiters_[kept] != &waiter) waiters_[kept] = std::move(waiter);
        ++kept;
      }
    }
    waiters_.resize(kept);
    CountAwaited();
  }
  for (const auto& observer : observers) (*observer)(frame);
  Call(completions);
}

void CommandBoard::RestartWaiting(Nanoseconds now) {
  const MutexLock lock(mutex_);
  for (Slot& slot : slots_) slot.waiting_since = now;
}

std::vector<FiredDeadline> CommandBoard::FireDeadlines(Nanoseconds now) {
  const MutexLock lock(mutex_);
  std::vector<FiredDeadline> fired;
  if (awaited_ == 0) return fired;
  for (Slot& slot : slots_) {
    if (!slot.deadline_s || !IsAwaited(slot) || now < DeadlineOf(*slot.deadline_s, slot.waiting_since))
      continue;
    ApplyPolicy(slot, slot.on_deadline);
    fired.push_back({slot.robot, slot.on_deadline});
  }
  CountAwaited();
  return fired;
}

Nanoseconds CommandBoard::NextDeadline() const {
  const MutexLock lock(mutex_);
  Nanoseconds next = kNever;
  if (awaited_ == 0) return next;
  for (const Slot& slot : slots_) {
    if (slot.deadline_s && IsAwaited(slot))
      next = std::min(next, DeadlineOf(*slot.deadline_s, slot.waiting_since));
  }
  return next;
}

void CommandBoard::Stop(FramePtr frame) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    EndAllWaits(StepEnd::kStopping, frame, completions);
    CountAwaited();
  }
  Call(completions);
}

}  // namespace coopdyn
