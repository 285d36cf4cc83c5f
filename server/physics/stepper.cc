// SPDX-License-Identifier: MIT
// The loop: when a step runs. What edits do is in stepper_edits.cc.
#include "server/physics/stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace coopdyn {

namespace {

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();
constexpr Nanoseconds kStatusEvery = 50'000'000;
/// While the real-time factor still has to fall to 0, a standing world is looked at this often.
constexpr Nanoseconds kLookAgain = 250'000'000;

}  // namespace

Stepper::Stepper(Boards boards, const Clock& clock, Logger logger, RunOptions options, StepHelpers helpers)
    : boards_(boards), clock_(clock), logger_(std::move(logger)), options_(options), helpers_(helpers) {
  boards_.commands.set_all_ready_hook([this] { StepHere(); });
}

bool Stepper::Start(std::shared_ptr<const Scenario> scenario, Diagnostics& diagnostics) {
  baton_.Take();
  seed_ = options_.seed.value_or(scenario->simulation.seed);
  auto scene = MakeScene(scenario, 1);
  auto world = BuildWorld(scene, seed_, diagnostics);
  const bool built = world != nullptr;
  if (built) {
    paused_ = options_.paused;
    mode_ = options_.mode.value_or(scenario->simulation.mode.value_or(Mode::kRealtime));
    if (options_.speed) speeds_[static_cast<std::size_t>(mode_)] = options_.speed;
    TakeOptions(scenario->simulation);
    Install(std::move(world), std::move(scene), StepEnd::kLoad);
  }
  baton_.Pass();
  return built;
}

void Stepper::Run(std::stop_token stop) {
  while (!stop.stop_requested()) {
    const std::uint64_t seen = boards_.bell.count();
    const Nanoseconds wake = WorkOnce();
    if (wake > clock_.Now()) boards_.bell.WaitUntil(seen, wake);
  }
  baton_.Take();
  stopping_ = true;
  baton_.Pass();
  boards_.edits.Close();
  boards_.commands.Stop(boards_.frames.Latest());
}

Nanoseconds Stepper::WorkOnce() {
  baton_.Take();
  ApplyEdits();
  const Nanoseconds now = clock_.Now();
  Nanoseconds wake = StepIfDue(now);
  const bool sleeps = wake > now + kStatusEvery;
  PublishStatus(now, sleeps);
  if (sleeps && status_.real_time_factor > 0) wake = std::min(wake, now + kLookAgain);
  looks_again_at_ = wake;
  baton_.Pass();
  return wake;
}

void Stepper::StepHere() {
  if (!baton_.TryTake()) {
    boards_.bell.Ring();
    return;
  }
  bool wake_physics = true;
  if (mode_ == Mode::kLockstep && may_step() && speed() <= 0 && boards_.edits.empty() &&
      boards_.commands.AllReady()) {
    const Nanoseconds now = clock_.Now();
    StepNow(now);
    PublishStatus(now, false);
    wake_physics = (may_step() && boards_.commands.AllReady()) || !boards_.edits.empty() ||
                   (has_deadlines_ && boards_.commands.NextDeadline() < looks_again_at_);
  }
  baton_.Pass();
  if (wake_physics) boards_.bell.Ring();
}

Nanoseconds Stepper::StepIfDue(Nanoseconds now) {
  if (!may_step()) return kNever;
  if (mode_ == Mode::kLockstep && !boards_.commands.AllReady()) {
    for (const FiredDeadline& fired : boards_.commands.FireDeadlines(now)) {
      const char* what = fired.policy == LossPolicy::kHold   ? "its set-points are held"
                         : fired.policy == LossPolicy::kStop ? "it is stopped"
                                                             : "it is dropped";
      AddEvent("warning", fired.robot + " missed its deadline: " + what + " until its next command");
    }
    if (!boards_.commands.AllReady()) return boards_.commands.NextDeadline();
  }
  const double limit = speed();
  if (limit <= 0) {
    StepNow(now);
    return now;
  }
  if (!pacer_.started()) pacer_.Start(now, step_length_, limit);
  if (now < pacer_.due()) return pacer_.due();
  const std::int64_t skipped = pacer_.Advance(now);
  if (mode_ == Mode::kRealtime) status_.late_periods += static_cast<std::uint64_t>(skipped);
  StepNow(now);
  return pacer_.due();
}

void Stepper::StepNow(Nanoseconds now) {
  const std::span<const Setpoint> setpoints = TakeSetpoints();
  const int substeps = std::max(DefaultSubsteps(step_length_), substeps_.value_or(1));
  const Nanoseconds began = clock_.Now();
  world_->Step(step_length_, substeps, setpoints);
  const Nanoseconds stepped = clock_.Now();
  ++step_;
  time_ += step_length_;
  if (allowed_steps_ > 0) --allowed_steps_;
  std::shared_ptr<Frame> frame = MakeFrame();
  for (std::size_t i = 0; i < setpoints.size(); ++i) frame->robots[i].setpoint_rad_s = setpoints[i];
  frame->messages = messages_;
  boards_.frames.Publish(frame);
  times_.physics += stepped - began;
  times_.publish += clock_.Now() - stepped;
  if (has_controllers_) NoteStoppedControllers();
  for (const FrozenBody& frozen : world_->TakeFrozen()) {
    status_.frozen.push_back(frozen.name);
    AddEvent("error", frozen.name + " exploded (" + frozen.why + ") and is frozen where it was last sane");
  }
  NoteFloorLeft(*frame);
  rate_.Note(now, time_);
  if (duration_ && time_ >= *duration_) {
    ended_ = true;
    AddEvent("info", "the run has reached its duration");
  }
  boards_.commands.FinishStep(frame, now);
  if (ended_) {
    PublishStatus(now, true);
    if (on_ended_) on_ended_();
  }
}

std::span<const Setpoint> Stepper::TakeSetpoints() {
  const std::span<Setpoint> setpoints = boards_.commands.Latch(step_ + 1);
  const std::uint64_t oldest = step_ + 1 - std::min(step_ + 1, message_steps_);
  std::erase_if(messages_, [oldest](const SentMessage& sent) { return sent.step < oldest; });
  const auto first = static_cast<std::ptrdiff_t>(messages_.size());
  const std::span<const SentMessage> sent = boards_.commands.LatchedMessages();
  messages_.insert(messages_.end(), sent.begin(), sent.end());
  if (!has_controllers_) return setpoints;
  helpers_.controllers->Step(boards_.frames.Latest(), setpoints, messages_);
  std::stable_sort(messages_.begin() + first, messages_.end(),
                   [](const SentMessage& a, const SentMessage& b) { return a.robot < b.robot; });
  return setpoints;
}

void Stepper::NoteStoppedControllers() {
  for (const StoppedController& stopped : helpers_.controllers->TakeStopped()) {
    AddEvent("error", stopped.robot + " stands: " + stopped.why);
    const int robot = scene_->FindRobot(stopped.robot);
    if (robot < 0) continue;
    const std::string& name = scene_->robots[static_cast<std::size_t>(robot)].entry.controller.name;
    boards_.commands.SetDriven(static_cast<std::size_t>(robot), name + " (stopped)", clock_.Now());
  }
}

std::shared_ptr<Frame> Stepper::MakeFrame() {
  std::shared_ptr<Frame> frame = frames_.Take();
  frame->step = step_;
  frame->time = time_;
  frame->step_length = step_length_;
  frame->seed = seed_;
  frame->scene = scene_;
  world_->Fill(*frame);
  return frame;
}

void Stepper::NoteFloorLeft(const Frame& frame) {
  const double half_length = scene_->floor.length_m / 2;
  const double half_width = scene_->floor.width_m / 2;
  for (std::size_t i = 0; i < chassis_.size(); ++i) {
    const Vector3& p = frame.bodies[chassis_[i]].p_WB;
    const bool off = std::abs(p.x()) > half_length || std::abs(p.y()) > half_width;
    if (off && !off_floor_[i]) AddEvent("warning", scene_->robots[i].entry.name + " has left the floor");
    off_floor_[i] = off;
  }
}

PhaseTimes Stepper::phase_times() {
  baton_.Take();
  PhaseTimes times = times_;
  baton_.Pass();
  if (helpers_.controllers != nullptr) {
    const PhaseTimes outside = helpers_.controllers->times();
    times.sense += outside.sense;
    times.control += outside.control;
  }
  return times;
}

double Stepper::speed() const {
  const auto& given = speeds_[static_cast<std::size_t>(mode_)];
  return given.value_or(mode_ == Mode::kRealtime ? 1.0 : 0.0);
}

void Stepper::RestartPace(Nanoseconds now) {
  pacer_.Stop();
  if (speed() > 0) pacer_.Start(now, step_length_, speed());
  boards_.commands.RestartWaiting(now);
}

void Stepper::PublishStatus(Nanoseconds now, bool always) {
  if (!always && now - status_at_ < kStatusEvery) return;
  status_at_ = now;
  status_.mode = mode_;
  status_.step_length = step_length_;
  status_.speed = speed();
  status_.state = ended_ ? RunState::kEnded : paused_ ? RunState::kPaused : RunState::kRunning;
  status_.real_time_factor = rate_.Factor(now, time_);
  boards_.control.SetStatus(status_);
}

void Stepper::AddEvent(const char* level, std::string text) {
  logger_->log(level == std::string_view("error")     ? spdlog::level::err
               : level == std::string_view("warning") ? spdlog::level::warn
                                                      : spdlog::level::info,
               "step {}: {}", step_, text);
  boards_.control.AddEvent({step_, ToSeconds(time_), level, std::move(text)});
}

}  // namespace coopdyn
