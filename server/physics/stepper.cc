// SPDX-License-Identifier: MIT
// The loop: when a step runs. stepper_edits.cc applies edits.
#include "server/physics/stepper.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "server/state/score_keeper.h"

namespace coopdyn {

namespace {

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();
constexpr Nanoseconds kStatusEvery = 50'000'000;
/// How often a world that stands still is checked until its real-time factor has fallen to 0.
constexpr Nanoseconds kLookAgain = 250'000'000;
/// Limits of the steps that a robot's thread runs for its own command: its other connections wait meanwhile,
/// and after more steps its subscribers would lose frames.
constexpr Nanoseconds kTurnHere = 500'000;
constexpr int kStepsHere = 32;

std::string SilentText(const std::string& client, Nanoseconds silent) {
  return fmt::format("{} has been silent for {:.1f} s", client, ToSeconds(silent));
}

}  // namespace

Stepper::Stepper(Boards boards, const Clock& clock, Logger logger, RunOptions options, StepHelpers helpers)
    : boards_(boards), clock_(clock), logger_(std::move(logger)), options_(options), helpers_(helpers) {
  boards_.commands.set_all_ready_hook([this] { StepHere(); });
}

bool Stepper::Start(std::shared_ptr<const Scenario> scenario, Diagnostics& diagnostics) {
  baton_.Take();
  const std::uint64_t seed = options_.seed.value_or(scenario->simulation.seed);
  auto simulation = BuildSimulation(MakeScene(scenario), seed, diagnostics);
  const bool built = simulation != nullptr;
  if (built) {
    simulation_ = std::move(simulation);
    paused_ = options_.paused;
    mode_ = options_.mode.value_or(scenario->simulation.mode.value_or(Mode::kRealtime));
    if (options_.speed) speeds_[static_cast<std::size_t>(mode_)] = options_.speed;
    TakeOptions(scenario->simulation);
    simulation_->SetStepLength(step_length_);
    simulation_->StartControllers();
    Install(StepEnd::kLoad);
  }
  baton_.Pass();
  return built;
}

bool Stepper::StartFrom(const SavedStatePtr& state, Diagnostics& diagnostics) {
  baton_.Take();
  auto simulation = BuildSimulation(state->frame->scene, state->frame->seed, diagnostics);
  bool built = simulation != nullptr;
  if (const std::string why = built ? simulation->Restore(*state, NextEpoch()) : ""; !why.empty()) {
    diagnostics.Error({state->frame->scene->scenario->file, 0}, "the run cannot continue from there: " + why);
    built = false;
  }
  if (built) {
    simulation_ = std::move(simulation);
    paused_ = options_.paused || state->paused;
    mode_ = options_.mode.value_or(state->mode);
    if (options_.speed) speeds_[static_cast<std::size_t>(mode_)] = options_.speed;
    TakeOptions(state->frame->scene->scenario->simulation);
    if (!options_.step) step_length_ = LengthOf(*state);
    if (options_.steps) {
      const Frame& at = *state->frame;
      const std::uint64_t left = *options_.steps - std::min(*options_.steps, at.step);
      duration_ = at.time + static_cast<Nanoseconds>(left) * step_length_;
    }
    InstallState(*state, StepEnd::kLoad);
  }
  baton_.Pass();
  return built;
}

void Stepper::WaitForRun() {
  baton_.Take();
  waits_for_run_ = true;
  baton_.Pass();
}

bool Stepper::TakeOver(Edit edit) {
  baton_.Take();
  ApplyEdit(edit);
  const bool live = simulation_ != nullptr;
  baton_.Pass();
  return live;
}

std::optional<Stepper::PutAside> Stepper::Run(std::stop_token stop) {
  UrgentThread thread;
  // An edit from before the start (a recording) takes effect even if the run ends at once.
  baton_.Take();
  ApplyEdits();
  waits_for_run_ = false;
  baton_.Pass();
  while (!stop.stop_requested()) {
    const std::uint64_t seen = boards_.bell.count();
    std::optional<PutAside> put_aside;
    const Nanoseconds wake = WorkOnce(stop, thread, put_aside);
    if (put_aside) return put_aside;
    if (wake > clock_.Now()) boards_.bell.WaitUntil(seen, wake);
  }
  baton_.Take();
  RestControllers();
  stopping_ = true;
  if (const auto end = boards_.control.end(); end && duration_ && !ended_ && options_.ends_daemon) {
    AddEvent("warning", fmt::format("the run ended early {}, at {:.2f} of {:g} s", WhyEarly(*end),
                                    frame().time_s(), ToSeconds(*duration_)));
  }
  PublishStatus(clock_.Now(), true);  // the last step's
  baton_.Pass();
  boards_.edits.Close(boards_.control.stopping_text());
  boards_.commands.Stop(boards_.frames.Latest(), boards_.control.stopping_text());
  return std::nullopt;
}

Nanoseconds Stepper::WorkOnce(const std::stop_token& stop, UrgentThread& thread,
                              std::optional<PutAside>& put_aside) {
  baton_.Take();
  ApplyEdits();
  put_aside = std::exchange(put_aside_, std::nullopt);
  if (!thread.Set(mode_ == Mode::kRealtime && speed() > 0)) {
    status_.load.priority_refused = true;
    logger_->debug("the stepping thread has no higher priority: `ulimit -e 30` or LimitNICE=-10 allows it");
  }
  const Nanoseconds now = clock_.Now();
  // Loading many robots takes seconds, and so does their first step.
  Nanoseconds wake = stop.stop_requested() ? now : StepIfDue(now);
  const bool sleeps = wake > now + kStatusEvery;
  PublishStatus(now, sleeps);
  if (wake > now) RestControllers();
  if (sleeps && status_.real_time_factor > 0) wake = std::min(wake, now + kLookAgain);
  next_check_at_ = wake;
  baton_.Pass();
  return wake;
}

void Stepper::StepHere() {
  if (!baton_.TryTake()) {
    boards_.bell.Ring();
    return;
  }
  Nanoseconds now = clock_.Now();
  const Nanoseconds end = now + kTurnHere;
  int ran = 0;
  while (!waits_for_run_ && mode_ == Mode::kLockstep && may_step() && speed() <= 0 && boards_.edits.empty() &&
         boards_.commands.AllReady()) {
    if (ran == kStepsHere || (ran > 0 && now >= end)) break;  // one step always runs
    StepNow(now);
    ++ran;
    PublishStatus(now, false);
    now = clock_.Now();
  }
  if (ran > 0) RestControllers();
  const bool wake_physics = ran == 0 || (may_step() && boards_.commands.AllReady()) ||
                            !boards_.edits.empty() ||
                            (has_deadlines_ && boards_.commands.NextDeadline() < next_check_at_);
  baton_.Pass();
  if (wake_physics) boards_.bell.Ring();
}

Nanoseconds Stepper::StepIfDue(Nanoseconds now) {
  if (!may_step()) return kNever;
  if (mode_ == Mode::kLockstep && !boards_.commands.AllReady()) {
    for (const FiredDeadline& fired : boards_.commands.FireDeadlines(now)) {
      const bool hold = fired.policy == LossPolicy::kHold, stop = fired.policy == LossPolicy::kStop;
      const std::string what = hold ? "its set-points are held" : stop ? "it is stopped" : "it is dropped";
      WriteInput(frame().step, DeadlineFired{fired.robot, fired.policy});
      const std::string text = "missed its deadline: " + what + " until its next command";
      if (!hold) NoteStopped(fired.robot, "deadline", text);
      AddEvent("warning", fired.robot + " " + text);
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
  const std::uint64_t before = frame().step;
  if (mode_ == Mode::kRealtime && now >= next_watchdog_at_) {
    boards_.commands.StopSilent(now);
    next_watchdog_at_ = now + kStatusEvery;
  }
  StepInputs inputs;
  inputs.setpoints = boards_.commands.Latch(before + 1);
  inputs.messages = boards_.commands.LatchedMessages();
  inputs.commanded = boards_.commands.LatchedCommands();
  if (!boards_.commands.LatchedLosses().empty()) NoteLostClients();
  const FramePtr seen = simulation_->frame();
  FramePtr frame = simulation_->Step(step_length_, inputs);
  Supervision supervision;
  if (simulation_->has_controllers()) supervision = helpers_.controllers->TakeSupervision();
  NoteLogs(supervision.logs, *seen);
  if (allowed_steps_ > 0) --allowed_steps_;
  status_.simulated += step_length_;
  boards_.frames.Publish(frame);
  if (simulation_->has_controllers()) NoteStoppedControllers(helpers_.controllers->TakeStopped(), before);
  for (const FrozenBody& frozen : simulation_->TakeFrozen()) {
    status_.frozen.push_back(frozen.name);
    AddEvent("error", frozen.name + " exploded (" + frozen.why + ") and is frozen where it was last sane");
  }
  NoteUnsolved();
  NoteFloorLeft(*frame, false);
  rate_.Note(now, frame->time);
  if (const int ending = EndingScore(*frame); ending >= 0) {
    const ScoreEntry& score = frame->scene->scenario->scores[static_cast<std::size_t>(ending)];
    const Score& now = frame->scores[static_cast<std::size_t>(ending)];
    EndRun(now.met ? RunEnd::kScore : RunEnd::kLimit,
           fmt::format("the score {} is {:.6g} {}: {}", score.name, now.value, UnitOf(score.kind),
                       now.met ? "the run has reached its goal" : "its time limit is reached"));
  }
  if (duration_ && frame->time >= *duration_) EndRun(RunEnd::kDuration, "the run has reached its duration");
  const Nanoseconds told = clock_.Now();
  if (journal_ != nullptr) {
    std::shared_ptr<SavedState> keyframe;
    if (journal_->WantsKeyframe(frame->step)) {
      keyframe = std::make_shared<SavedState>(simulation_->Save());
      keyframe->mode = mode_;
    }
    journal_->Step(frame, mode_, std::move(keyframe), told);
  }
  if (!supervision.empty()) {
    Supervise(supervision);
    frame = simulation_->frame();
  }
  const Nanoseconds written = journal_ != nullptr ? clock_.Now() : told;
  boards_.commands.FinishStep(frame, now);
  NoteCosts(now, told, written);
  if (ended_) {
    PublishStatus(now, true);
    NotifyEnded();
  }
}

void Stepper::NoteUnsolved() {
  const std::vector<std::string> unsolved = simulation_->TakeUnsolved();
  if (!unsolved.empty() && status_.unsolved == 0) {
    AddEvent("warning", "the joints and contacts of " + unsolved.front() +
                            " were not solved exactly in this step: forces and efforts are approximate. "
                            "'unsolved' in get_status counts such substeps; shorter steps help");
  }
  status_.unsolved += unsolved.size();
}

void Stepper::NoteCosts(Nanoseconds began, Nanoseconds told, Nanoseconds written) {
  const Nanoseconds ended = clock_.Now();
  StepCosts& costs = status_.costs;
  ++costs.steps;
  costs.busy += ended - began;
  costs.journal += written - told;
  costs.answer += ended - written;
  if (idle_since_ > 0) costs.idle += began - idle_since_;
  idle_since_ = ended;
  if (!may_step()) IgnoreRest();
}

void Stepper::IgnoreRest() {
  idle_since_ = 0;
  boards_.commands.IgnoreWait();
}

void Stepper::NoteStoppedControllers(const std::vector<StoppedController>& controllers,
                                     std::optional<std::uint64_t> step) {
  const Scene& scene = simulation_->scene();
  bool failed = false;
  for (const StoppedController& stopped : controllers) {
    const bool drives = scene.FindRobot(stopped.robot) >= 0;
    AddEvent(stopped.with_daemon ? "info" : "error",
             drives ? stopped.robot + " stands: " + stopped.why
                    : "the run no longer has a supervisor: " + stopped.why);
    if (!stopped.with_daemon) NoteStopped(stopped.robot, "controller", stopped.why);
    failed |= !stopped.with_daemon;
    if (step) WriteInput(*step, ControllerStopped{stopped.robot, stopped.why});
    const int robot = scene.FindRobot(stopped.robot);
    if (robot < 0) continue;
    const std::string& name = scene.robots[static_cast<std::size_t>(robot)].entry.controller.name;
    boards_.commands.SetDriven(static_cast<std::size_t>(robot), name + " (stopped)", clock_.Now());
  }
  if (failed && options_.stop_on_controller_failure) {
    EndRun(RunEnd::kController, "the run ends: a controller has failed (--on-controller-failure stop)");
  }
}

void Stepper::NoteStopped(const std::string& robot, const char* by, const std::string& why) {
  boards_.control.AddStopped(robot, {by, frame().step, frame().time_s(), why});
}

void Stepper::EndRun(RunEnd why, std::string text) {
  if (ended_) return;
  ended_ = true;
  if (options_.ends_daemon || why == RunEnd::kController) boards_.control.End(why, text);
  status_.ended = text;
  boards_.commands.NoteRunEnded();
  AddEvent("info", std::move(text));
}

void Stepper::NotifyEnded() {
  if (boards_.control.end() && on_ended_) return on_ended_();
  boards_.commands.Stop(simulation_->frame(), EndedText());  // until Configure()
}

void Stepper::NoteLostClients() {
  constexpr std::size_t kNamed = 4;
  std::map<std::tuple<std::string, LossPolicy, Nanoseconds>, std::vector<std::string>> by_client;
  for (const LostClient& lost : boards_.commands.LatchedLosses()) {
    const std::string& robot = simulation_->scene().robots[lost.robot].entry.name;
    std::vector<std::string>& robots = by_client[{lost.client, lost.policy, lost.silent}];
    if (!robots.empty() && robots.back() == robot) continue;  // another module of the same robot
    robots.push_back(robot);
    WriteInput(frame().step, ClientLost{robot, lost.policy});
    if (lost.silent > 0) {
      NoteStopped(robot, "watchdog", SilentText(lost.client, lost.silent));
    } else if (lost.policy != LossPolicy::kHold) {
      NoteStopped(robot, "client", "lost its client " + lost.client);
    }
  }
  for (const auto& [key, robots] : by_client) {
    const auto& [client, policy, silent] = key;
    const char* what = policy == LossPolicy::kHold   ? "set-points held"
                       : policy == LossPolicy::kStop ? "stopped"
                                                     : "dropped";
    std::string names;
    for (std::size_t i = 0; i < robots.size() && i < kNamed; ++i) names += (i > 0 ? ", " : "") + robots[i];
    if (robots.size() > kNamed) names += " and " + std::to_string(robots.size() - kNamed) + " more";
    if (silent > 0) {
      const char* until =
          robots.size() > 1 ? " are stopped until their next command" : " is stopped until its next command";
      AddEvent("warning", SilentText(client, silent) + ": " + names + until +
                              " ('watchdog' in the scenario sets this time, or off)");
    } else {
      AddEvent("info", "lost client " + client + ": " + names + " " + what);
    }
  }
}

void Stepper::RestControllers() {
  if (helpers_.controllers != nullptr) helpers_.controllers->Rest();
}

void Stepper::NoteFloorLeft(const Frame& frame, bool first) {
  const Scene& scene = simulation_->scene();
  off_floor_.resize(scene.robots.size());
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const Vector3& p = frame.bodies[static_cast<std::size_t>(scene.robots[i].first_body)].p_WB;
    const char off = scene.floor.IsUnder(p.x(), p.y()) ? 0 : 1;
    if (off == off_floor_[i]) continue;
    off_floor_[i] = off;
    if (off == 1 && !first) AddEvent("warning", scene.robots[i].entry.name + " has left the floor");
  }
}

PhaseTimes Stepper::phase_times() {
  baton_.Take();
  const PhaseTimes times = AllTimes();
  baton_.Pass();
  return times;
}

PhaseTimes Stepper::AllTimes() const {
  PhaseTimes times = simulation_ != nullptr ? simulation_->times() : PhaseTimes();
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
  idle_since_ = 0;
}

void Stepper::PublishStatus(Nanoseconds now, bool always) {
  if (!always && now - status_at_ < kStatusEvery) return;
  status_at_ = now;
  status_.mode = mode_;
  status_.step_length = step_length_;
  status_.speed = speed();
  status_.undo = history_.undo_count();
  status_.redo = history_.redo_count();
  status_.state = ended_ ? RunState::kEnded : paused_ ? RunState::kPaused : RunState::kRunning;
  status_.duration_s = duration_ && options_.ends_daemon ? ToSeconds(*duration_) : 0;
  status_.real_time_factor = rate_.Factor(now, simulation_ != nullptr ? frame().time : 0);
  const PhaseTimes times = AllTimes();
  status_.costs.times = {times.sense - times_before_.sense, times.control - times_before_.control,
                         times.physics - times_before_.physics, times.publish - times_before_.publish};
  if (mode_ == Mode::kRealtime && simulation_ != nullptr) {
    status_.load.times = times;
    if (helpers_.controllers != nullptr) {
      const ControllerCost slowest = helpers_.controllers->slowest();
      status_.load.controller = slowest.controller;
      status_.load.controller_step = slowest.per_step;
    }
  }
  boards_.control.SetStatus(status_);
}

void Stepper::AddEvent(const char* level, std::string text) {
  const Frame& newest = frame();
  logger_->log(level == std::string_view("error")     ? spdlog::level::err
               : level == std::string_view("warning") ? spdlog::level::warn
                                                      : spdlog::level::info,
               "step {}: {}", newest.step, text);
  Event event{newest.step, newest.time_s(), level, std::move(text)};
  if (journal_ != nullptr) journal_->Note(event);
  boards_.control.AddEvent(std::move(event));
}

void Stepper::WriteInput(std::uint64_t step, std::variant<RunEdit, RobotEvent, WorldInput> what) {
  if (journal_ != nullptr) journal_->Input({step, std::move(what)});
}

std::uint64_t Stepper::NextEpoch() const {
  const FramePtr newest = boards_.frames.Latest();
  return newest == nullptr ? 1 : newest->epoch + 1;
}

}  // namespace coopdyn
