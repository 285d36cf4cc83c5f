// SPDX-License-Identifier: MIT
// The part of the board called by the stepping thread: layout, modes, steps, deadlines; and the ends of
// waits.
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

bool CommandBoard::NoteChange(std::size_t index, bool was_awaited, std::optional<Nanoseconds>& now) {
  const bool is_awaited = table_.drive(index).is_awaited();
  if (was_awaited == is_awaited) return false;
  awaited_ += is_awaited ? 1 : -1;
  if (mode_ != Mode::kLockstep) return false;
  if (!is_awaited) NoteReady(index, awaited_ == 0, now);
  return awaited_ == 0;
}

void CommandBoard::Completions::Call() const {
  StepResult result{StepEnd::kRan, frame, mode, 0, 0, why};
  for (const auto& [done, end] : calls) {
    result.end = end;
    done(result);
  }
}

void CommandBoard::ReplacePending(std::size_t index, const Client& client, Completions& completions) {
  const Drive& drive = table_.drive(index);
  if (!drive.pending || drive.pending_from == client.id) return;
  const std::uint64_t batch = drive.batch;
  EndPending(index, StepEnd::kReplaced, completions);
  LeaveBatch(batch, StepEnd::kReplaced, completions);
}

void CommandBoard::LeaveBatch(std::uint64_t batch, StepEnd end, Completions& completions) {
  if (batch == 0) return;
  const auto waiter = std::ranges::find(waiters_, batch, &Waiter::batch);
  if (waiter == waiters_.end() || --waiter->members != 0) return;
  completions.calls.emplace_back(std::move(waiter->done), end);
  waiters_.erase(waiter);
}

void CommandBoard::Revise(const Scene& scene, std::span<const int> unloaded, FramePtr frame,
                          Nanoseconds now) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    last_frame_ = std::move(frame);
    completions = MakeCompletions();
    std::vector<std::uint32_t> robots;  // old index → new index, or kGone
    constexpr std::uint32_t kGone = static_cast<std::uint32_t>(-1);
    for (std::size_t i = 0; i < table_.robot_count(); ++i) {
      const int place = scene.FindRobot(table_.slot(table_.first_slot(i)).robot);
      robots.push_back(place < 0 ? kGone : static_cast<std::uint32_t>(place));
    }
    for (DriveTable::Leaving& left : table_.Revise(scene, unloaded)) {
      if (left.done) completions.calls.emplace_back(std::move(left.done), StepEnd::kRemoved);
      LeaveBatch(left.batch, StepEnd::kRemoved, completions);
    }
    const auto moved = [&](std::uint32_t robot) { return robot < robots.size() ? robots[robot] : kGone; };
    // Waiting broadcasts and lost clients refer to robots by index.
    std::vector<SentMessage> messages;
    for (std::size_t i = 0; i < table_.size(); ++i) {
      std::uint32_t& message = table_.slot(i).message;
      if (message >= messages_.size()) continue;
      messages.push_back(messages_[message]);
      messages.back().robot = table_.drive(i).robot;
      message = static_cast<std::uint32_t>(messages.size() - 1);
    }
    messages_ = std::move(messages);
    std::erase_if(losses_, [&](LostClient& loss) {
      const std::uint32_t robot = moved(static_cast<std::uint32_t>(loss.robot));
      loss.robot = robot;
      return robot == kGone;
    });
    latched_ = table_.in_force();
    latched_commands_.assign(table_.size(), 0);
    latched_messages_.clear();
    latched_losses_.clear();
    std::vector<WaitTimes> times(table_.robot_count());
    for (std::size_t i = 0; i < robots.size() && i < wait_times_.size(); ++i) {
      if (robots[i] != kGone) times[robots[i]] = wait_times_[i];
    }
    wait_times_ = std::move(times);
    waiting_since_ = now;
    waits_from_ = 0;
    awaited_ = table_.CountAwaited();
    NoteTeams();
    layout_revision_.fetch_add(1, std::memory_order_release);
  }
  completions.Call();
}

void CommandBoard::EndAllWaits(StepEnd end, Completions& completions) {
  for (std::size_t i = 0; i < table_.size(); ++i) EndPending(i, end, completions);
  for (Waiter& waiter : waiters_) completions.calls.emplace_back(std::move(waiter.done), end);
  waiters_.clear();
}

void CommandBoard::ClearMessages() {
  for (const SentMessage& sent : messages_)
    table_.slot(table_.first_slot(sent.robot)).message = Slot::kNoMessage;
  messages_.clear();
}

void CommandBoard::Configure(const Scene& scene, StepEnd end, FramePtr frame, Nanoseconds now) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    run_ended_.store(false, std::memory_order_release);
    stopping_ = false;
    why_stopping_.clear();
    last_frame_ = std::move(frame);
    completions = MakeCompletions();
    EndAllWaits(end, completions);
    messages_.clear();
    losses_.clear();
    table_.Configure(scene, end == StepEnd::kReset);
    latched_ = table_.in_force();
    latched_commands_.assign(table_.size(), 0);
    latched_messages_.clear();
    latched_losses_.clear();
    wait_times_.assign(table_.robot_count(), {});
    waited_ = waits_from_ = newest_ready_ = ready_before_ = 0;
    waiting_since_ = now;
    awaited_ = table_.CountAwaited();
    programs_ = scene.scenario->simulation.waits_for;
    for (auto& [id, reader] : readers_) reader.taken = last_frame_->step;
    NoteTeams();
    layout_revision_.fetch_add(1, std::memory_order_release);
  }
  completions.Call();
}

void CommandBoard::SetMode(Mode mode, Nanoseconds now) {
  const MutexLock lock(mutex_);
  mode_ = mode;
  is_real_time_.store(mode == Mode::kRealtime, std::memory_order_relaxed);
  waiting_since_ = silence_from_ = now;
  waits_from_ = 0;
  if (mode == Mode::kLockstep) return;
  // Lockstep waited for these programs; without it, their robots would keep driving.
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_.drive(i).abandoned) StopAbandoned(i);
  }
}

Mode CommandBoard::mode() const {
  const MutexLock lock(mutex_);
  return mode_;
}

Verdict CommandBoard::SetParticipants(std::span<const std::string> names, Nanoseconds now) {
  const MutexLock lock(mutex_);
  std::vector<bool> chosen(table_.robot_count(), false);
  for (const std::string& name : names) {
    const std::optional<std::size_t> robot = table_.FindRobot(name);
    if (!robot) return {Error::kNoSuchName, "no robot is called " + name + ": " + table_.NamesOfRobots()};
    const std::size_t first = table_.first_slot(*robot);
    const Drive& drive = table_.drive(first);
    if (drive.driven || !drive.has_module) {
      const std::string why = drive.driven ? " is driven by " + table_.Who(first) : " has no actuators";
      return {Error::kNotPossible, name + why + ": only robots that clients drive can be waited for"};
    }
    chosen[*robot] = true;
  }
  for (std::size_t i = 0; i < table_.size(); ++i) {
    Drive& drive = table_.drive(i);
    const Slot& slot = table_.slot(i);
    const bool by_scene = !drive.driven && slot.may_participate;
    drive.participates = names.empty() ? by_scene : chosen[drive.robot] && slot.may_be_awaited;
    drive.dropped = false;
  }
  waiting_since_ = now;
  awaited_ = table_.CountAwaited();
  return Fine();
}

void CommandBoard::SetDriven(std::size_t robot, const std::string& name, Nanoseconds now) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    if (robot >= table_.robot_count()) return;
    completions = MakeCompletions();
    for (std::size_t i = table_.first_slot(robot); i < table_.first_slot(robot + 1); ++i) {
      ReplacePending(i, Client{}, completions);
      Disown(i);
      Drive& drive = table_.drive(i);
      Slot& slot = table_.slot(i);
      table_.Stop(i);
      drive.excused = drive.dropped = drive.loses_client = drive.abandoned = false;
      drive.driven = !name.empty();
      drive.participates = !drive.driven && slot.may_participate;
      slot.controller = name;
      slot.former.id = 0;
    }
    waiting_since_ = now;
    awaited_ = table_.CountAwaited();
  }
  completions.Call();
}

void CommandBoard::SetInForce(std::span<const Setpoint> setpoints) {
  const MutexLock lock(mutex_);
  table_.SetInForce(setpoints);
}

std::vector<Setpoint> CommandBoard::InForce() const {
  const MutexLock lock(mutex_);
  return table_.in_force();
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
  for (std::size_t i = 0; i < table_.size(); ++i) table_.StopPending(i);
  ClearMessages();
}

bool CommandBoard::AllReady() const {
  const MutexLock lock(mutex_);
  return IsReady();
}

std::span<Setpoint> CommandBoard::Latch(std::uint64_t step) {
  const MutexLock lock(mutex_);
  table_.Latch(latched_commands_);
  std::ranges::copy(table_.in_force(), latched_.begin());
  for (Waiter& waiter : waiters_) waiter.latched = true;
  latched_messages_.clear();
  if (!messages_.empty()) {
    latched_messages_ = messages_;
    ClearMessages();
    // By robot: independent of the order of arrival.
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
    for (std::size_t i = 0; i < table_.size(); ++i) {
      Drive& drive = table_.drive(i);
      if (drive.pending && drive.latched && --drive.steps_left <= 0) {
        EndPending(i, StepEnd::kRan, completions);
        if (std::exchange(drive.loses_client, false)) ApplyLoss(i);
      }
      if (drive.is_awaited()) ++awaited_;
    }
    std::erase_if(waiters_, [&](Waiter& waiter) {
      if (!waiter.latched || --waiter.steps_left > 0) return false;
      completions.calls.emplace_back(std::move(waiter.done), StepEnd::kRan);
      return true;
    });
    calls_at_once_ = std::max(calls_at_once_, completions.calls.size());
    waits_from_ = 0;
  }
  for (const auto& observer : observers) (*observer)(frame);
  completions.Call();
  if (wait_clock_ == nullptr) return;
  const MutexLock lock(mutex_);  // everybody is answered: the world now waits for robots that are not ready
  if (mode_ == Mode::kLockstep) waits_from_ = wait_clock_->Now();
}

void CommandBoard::RestartWaiting(Nanoseconds now) {
  const MutexLock lock(mutex_);
  waiting_since_ = silence_from_ = now;
  waits_from_ = 0;
}

std::vector<FiredDeadline> CommandBoard::FireDeadlines(Nanoseconds now) {
  const MutexLock lock(mutex_);
  std::vector<FiredDeadline> fired;
  if (awaited_ == 0 || !table_.has_deadlines()) return fired;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const Slot& slot = table_.slot(i);
    if (!table_.drive(i).is_awaited() || !slot.deadline_s ||
        now < DeadlineOf(*slot.deadline_s, waiting_since_))
      continue;
    table_.ApplyPolicy(i, slot.on_deadline);
    if (fired.empty() || fired.back().robot != slot.robot) fired.push_back({slot.robot, slot.on_deadline});
  }
  awaited_ = table_.CountAwaited();
  return fired;
}

Nanoseconds CommandBoard::NextDeadline() const {
  const MutexLock lock(mutex_);
  Nanoseconds next = kNever;
  if (awaited_ == 0 || !table_.has_deadlines()) return next;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_.drive(i).is_awaited() && table_.slot(i).deadline_s)
      next = std::min(next, DeadlineOf(*table_.slot(i).deadline_s, waiting_since_));
  }
  return next;
}

void CommandBoard::Stop(FramePtr frame, std::string why) {
  Completions completions;
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    why_stopping_ = std::move(why);
    last_frame_ = std::move(frame);
    completions = MakeCompletions();
    EndAllWaits(StepEnd::kStopping, completions);
    awaited_ = table_.CountAwaited();
  }
  completions.Call();
}

}  // namespace coopdyn
