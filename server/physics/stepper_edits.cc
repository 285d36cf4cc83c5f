// SPDX-License-Identifier: MIT
// Applies each edit to the run between two steps. Called by the holder of the baton.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include "server/physics/stepper.h"
#include "server/state/world_moves.h"

namespace coopdyn {

namespace {

constexpr const char* kTooManyLogged = "{} names are already logged: log one of those";

}  // namespace

void Stepper::ApplyEdits() {
  for (Edit& edit : boards_.edits.TakeAll()) {
    if (put_aside_) {  // later edits are for the playback
      boards_.edits.Push(std::move(edit));
      continue;
    }
    RestControllers();  // an edit may start threads, which would inherit this thread's core
    ApplyEdit(edit);
  }
}

void Stepper::ApplyEdit(Edit& edit) {
  EditResult result = ApplyAny(edit.action);
  result.frame = boards_.frames.Latest();
  const bool fine = result.error == Error::kOk;
  if (fine && As<edit::Play>(edit.action) != nullptr) {
    put_aside_ = {std::move(edit), result.saved};
    return;
  }
  if (const auto* run = std::get_if<RunEdit>(&edit.action); run != nullptr && fine) {
    WriteInput(frame().step, *run);
  }
  const auto* step = As<edit::Step>(edit.action);
  const bool waits = step != nullptr && fine;
  if (waits) boards_.commands.WaitSteps(allowed_steps_, std::move(edit.stepped), step->steps);
  PublishStatus(clock_.Now(), true);
  if (edit.done && !waits) edit.done(result);
}

EditResult Stepper::ApplyAny(const EditAction& action) {
  const auto apply = [this](const auto& edit) REQUIRES(baton_) { return Apply(edit); };
  if (const auto* run = std::get_if<RunEdit>(&action)) return std::visit(apply, *run);
  if (const auto* world = std::get_if<WorldEdit>(&action)) return std::visit(apply, *world);
  if (const auto* scene = std::get_if<SceneEdit>(&action)) return std::visit(apply, *scene);
  if (const auto* record = std::get_if<RecordEdit>(&action)) return std::visit(apply, *record);
  return {Error::kNotPossible, kNotPlayingText};
}

std::string Stepper::EndedText() const {
  return RunEndedText(status_.ended) + ": reset starts it again";
}

EditResult Stepper::Apply(const edit::Run&) {
  if (ended_) return {Error::kNotPossible, EndedText()};
  if (paused_) {
    paused_ = false;
    allowed_steps_ = 0;
    RestartPace(clock_.Now());
  }
  return {};
}

EditResult Stepper::Apply(const edit::Pause&) {
  paused_ = true;
  IgnoreRest();
  allowed_steps_ = 0;
  boards_.commands.EndSteps();
  return {};
}

EditResult Stepper::Apply(const edit::Step& step) {
  if (ended_) return {Error::kNotPossible, EndedText()};
  if (!paused_) return {Error::kNotPossible, "step works only while paused: send pause first"};
  if (allowed_steps_ == 0) RestartPace(clock_.Now());
  allowed_steps_ += step.steps;
  return {};
}

EditResult Stepper::Apply(const edit::Reset& reset) {
  const std::uint64_t seed = reset.seed.value_or(frame().seed);
  if (reset.scenario != nullptr) {
    Diagnostics diagnostics;
    auto simulation = BuildSimulation(MakeScene(reset.scenario), seed, diagnostics);
    if (simulation == nullptr) return {Error::kNotPossible, diagnostics.ToString()};
    simulation_ = std::move(simulation);
    simulation_->SetStepLength(step_length_);
    simulation_->StartControllers();
  } else {
    simulation_->SetStepLength(step_length_);
    simulation_->Restart(seed, NextEpoch());
  }
  Install(StepEnd::kReset);
  history_.NoteReset();
  return {};
}

EditResult Stepper::ChangeWorld(WorldChange change, WorldHistory::Entry& entry, bool adds_event) {
  entry.epoch = frame().epoch;
  entry.step = frame().step;
  if (std::string why = simulation_->Change(change, entry.inverse); !why.empty()) {
    return {Error::kNotPossible, std::move(why)};
  }
  const Scene& scene = simulation_->scene();
  status_.frozen = FrozenNames(frame());
  NoteFloorLeft(frame(), true);
  has_deadlines_ = std::any_of(scene.robots.begin(), scene.robots.end(),
                               [](const SceneRobot& robot) { return robot.entry.deadline_s.has_value(); });
  boards_.frames.Publish(simulation_->frame());
  const bool has_host = helpers_.controllers != nullptr;
  std::vector<int> unloaded = has_host ? helpers_.controllers->Unloaded() : std::vector<int>();
  std::ranges::sort(unloaded);
  boards_.commands.Revise(scene, unloaded, simulation_->frame(), clock_.Now());
  WriteInput(frame().step, change);
  if (adds_event) AddEvent("info", change.label);
  if (simulation_->has_controllers()) {
    NoteStoppedControllers(helpers_.controllers->TakeStopped(), std::nullopt);
  }
  EditResult result;
  result.change = std::move(change);
  return result;
}

EditResult Stepper::Apply(const edit::Change& made) {
  WorldHistory::Entry entry;
  EditResult result = ChangeWorld(made.change, entry);
  if (result.error == Error::kOk) {
    entry.change = result.change;
    history_.Note(std::move(entry));
  }
  return result;
}

EditResult Stepper::Apply(const edit::Undo&) {
  if (!history_.can_undo()) {
    return {Error::kNotPossible, "there is nothing to undo: the world is unchanged since it was loaded"};
  }
  WorldHistory::Entry entry;
  EditResult result = ChangeWorld(history_.NextUndo(frame().epoch, frame().step), entry);
  if (result.error == Error::kOk) {
    history_.NoteUndone();
  } else {
    result.text = "this cannot be undone now: " + result.text;
  }
  return result;
}

EditResult Stepper::Apply(const edit::Redo&) {
  if (!history_.can_redo()) return {Error::kNotPossible, "there is nothing to redo"};
  WorldHistory::Entry entry;
  EditResult result = ChangeWorld(history_.NextRedo(), entry);
  if (result.error == Error::kOk) {
    history_.NoteRedone(std::move(entry));
  } else {
    result.text = "this cannot be redone now: " + result.text;
  }
  return result;
}

EditResult Stepper::Apply(const edit::Load& load) {
  Diagnostics diagnostics;
  const SimulationOptions& said = load.scenario->simulation;
  auto simulation = BuildSimulation(MakeScene(load.scenario), options_.seed.value_or(said.seed), diagnostics);
  if (simulation == nullptr) return {Error::kMalformed, diagnostics.ToString()};
  simulation_ = std::move(simulation);
  if (!options_.mode) mode_ = said.mode.value_or(mode_);
  TakeOptions(said);
  simulation_->SetStepLength(step_length_);
  simulation_->StartControllers();
  Install(StepEnd::kLoad);
  history_.Clear();
  return {};
}

EditResult Stepper::Apply(const edit::Restore& restore) {
  const SavedState& state = *restore.state;
  const bool live = simulation_ != nullptr;
  const SavedState present = live ? simulation_->Save() : SavedState();
  if (live && simulation_->scene().scenario == state.frame->scene->scenario) {
    if (const std::string why = simulation_->Restore(state, NextEpoch()); !why.empty()) {
      return RefuseRestore(why, present);
    }
    step_length_ = LengthOf(state);
    InstallState(state, StepEnd::kReset);
    return {};
  }
  Diagnostics diagnostics;
  auto simulation = BuildSimulation(state.frame->scene, state.frame->seed, diagnostics);
  if (simulation == nullptr) return {Error::kMalformed, diagnostics.ToString()};
  if (const std::string why = simulation->Restore(state, NextEpoch()); !why.empty()) {
    return RefuseRestore(why, present);
  }
  simulation_ = std::move(simulation);
  TakeOptions(state.frame->scene->scenario->simulation);
  step_length_ = LengthOf(state);
  if (!live) {
    mode_ = options_.mode.value_or(state.mode);
    paused_ = state.paused;
  }
  InstallState(state, StepEnd::kLoad);
  return {};
}

EditResult Stepper::Apply(const edit::Play&) {
  if (journal_ != nullptr) {
    return {Error::kNotPossible, "the run is being recorded: stop the recording first (/recorder stop)"};
  }
  EditResult result;
  result.saved = SaveState();
  boards_.commands.EndSteps();
  simulation_.reset();
  history_.Clear();
  return result;
}

EditResult Stepper::Apply(const edit::Note& note) {
  AddEvent("note", note.text);
  return {};
}

EditResult Stepper::Apply(const edit::Log& log) {
  if (ended_) return {Error::kNotPossible, "the run has ended: values after its last step are not logged"};
  if (LogNumber(log.name, log.value, frame())) return {};
  return {Error::kTooLarge, fmt::format(kTooManyLogged, RunControl::kMaxLogged)};
}

bool Stepper::LogNumber(const std::string& name, double value, const Frame& now) {
  if (!boards_.control.SetLogged(name, {now.step, now.time_s(), value})) return false;
  if (journal_ != nullptr)
    journal_->Note({now.step, now.time_s(), kLogLevel, fmt::format("{} {}", name, value)});
  return true;
}

void Stepper::NoteLogs(std::span<const Supervision::Log> logs, const Frame& seen) {
  for (const Supervision::Log& log : logs) {
    if (LogNumber(log.name, log.value, seen) || std::exchange(logs_lost_, true)) continue;
    AddEvent("warning", log.name + " is not logged: " + fmt::format(kTooManyLogged, RunControl::kMaxLogged));
  }
}

void Stepper::Supervise(const Supervision& supervision) {
  const std::string who = SupervisorName(simulation_->scene().scenario->simulation.supervisor);
  WorldChange change;
  std::string names, refusal;
  std::set<std::int32_t> moved;
  for (const Supervision::Move& move : supervision.moves) {
    const Found found = FindId(simulation_->scene(), move.id);
    if (!found.any()) refusal = fmt::format("there is nothing with the id {}", move.id);
    if (!moved.insert(move.id).second) refusal = fmt::format("{} is moved twice in one step", move.id);
    if (!refusal.empty()) break;
    names += " " + AddMove(frame(), found, move.X_W, change);
  }
  if (!supervision.moves.empty()) {
    change.label = who + ": move" + names;
    const auto before = std::exchange(moved_at_, frame().step);
    const bool continues_edit = before && *before + 1 == frame().step;
    WorldHistory::Entry entry;
    if (refusal.empty()) refusal = ChangeWorld(change, entry, !continues_edit).text;
    if (!refusal.empty() && refusal != not_moved_) AddEvent("warning", who + " moves nothing: " + refusal);
    not_moved_ = refusal;
  }
  if (!supervision.end || ended_) return;
  const bool is_robots =
      simulation_->scene().scenario->simulation.supervisor.empty();  // its own text names the robot
  EndRun(RunEnd::kSupervisor,
         is_robots ? *supervision.end
                   : who + " ends the run" + (supervision.end->empty() ? "" : ": " + *supervision.end));
}

EditResult Stepper::Apply(const edit::EndRun& end) {
  if (ended_) return {Error::kNotPossible, "the run has ended already"};
  EndRun(RunEnd::kClient, "a client ends the run" + (end.why.empty() ? "" : ": " + end.why));
  PublishStatus(clock_.Now(), true);
  NotifyEnded();
  return {};
}

EditResult Stepper::Apply(const edit::Save&) {
  EditResult result;
  result.saved = SaveState();
  return result;
}

SavedStatePtr Stepper::SaveState() const {
  auto state = std::make_shared<SavedState>(simulation_->Save());
  state->mode = mode_;
  state->paused = paused_;
  state->step_length = step_length_;
  state->setpoints = boards_.commands.InForce();
  return state;
}

EditResult Stepper::Apply(const edit::SetJournal& set) {
  journal_ = set.journal;
  if (journal_ != nullptr) journal_->Begin(SaveState());
  return {};
}

std::unique_ptr<Simulation> Stepper::BuildSimulation(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                                     Diagnostics& diagnostics) {
  return Simulation::Build(std::move(scene), seed, NextEpoch(), helpers_, clock_, diagnostics);
}

void Stepper::TakeOptions(const SimulationOptions& said) {
  if (const auto step = options_.step ? options_.step : said.step) step_length_ = *step;
  std::optional<double>& given = speeds_[static_cast<std::size_t>(mode_)];
  if (said.speed && !options_.speed) given = said.speed;
  std::optional<double> duration_s = options_.duration_s ? options_.duration_s : said.duration_s;
  if (options_.steps) duration_s = static_cast<double>(*options_.steps) * ToSeconds(step_length_);
  duration_.reset();
  if (duration_s) duration_ = std::llround(*duration_s * 1e9);
}

void Stepper::Install(StepEnd end, const SavedState* state) {
  const Scene& scene = simulation_->scene();
  ended_ = false;
  status_.ended.clear();
  allowed_steps_ = 0;
  status_.frozen_before.insert(status_.frozen.begin(), status_.frozen.end());
  status_.frozen = FrozenNames(frame());
  status_.unsolved = 0;
  moved_at_.reset();
  not_moved_.clear();
  logs_lost_ = false;
  boards_.control.ClearStopped();
  boards_.control.ClearLogged();
  status_.costs = {.runs = status_.costs.runs + 1};
  times_before_ = AllTimes();
  NoteFloorLeft(frame(), true);
  has_deadlines_ = std::any_of(scene.robots.begin(), scene.robots.end(),
                               [](const SceneRobot& robot) { return robot.entry.deadline_s.has_value(); });
  const Nanoseconds now = clock_.Now();
  boards_.frames.Publish(simulation_->frame());
  boards_.commands.SetMode(mode_, now);
  boards_.commands.Configure(scene, end, simulation_->frame(), now);
  if (state != nullptr) TakeDrives(*state, now);
  // Controllers that are stopped from the start are no input of the run: the saved state contains them.
  if (journal_ != nullptr) journal_->Begin(SaveState());
  if (helpers_.controllers != nullptr) {
    NoteStoppedControllers(helpers_.controllers->TakeStopped(), std::nullopt);
  }
  rate_.Reset();
  RestartPace(now);
  PublishStatus(now, true);
  if (ended_) NotifyEnded();
}

void Stepper::TakeDrives(const SavedState& state, Nanoseconds now) {
  if (helpers_.controllers != nullptr) {
    for (const int robot : helpers_.controllers->Unloaded()) {
      boards_.commands.SetDriven(static_cast<std::size_t>(robot), "", now);
    }
  }
  std::vector<Setpoint> setpoints = state.setpoints;
  if (setpoints.empty()) {
    for (const ChannelState& channel : state.frame->channels) setpoints.push_back(channel.setpoint);
  }
  boards_.commands.SetInForce(setpoints);
}

EditResult Stepper::RefuseRestore(const std::string& why, const SavedState& present) {
  std::string text = "this state cannot be restored: " + why;
  if (simulation_ != nullptr) {
    std::vector<StoppedController> stopped;
    const std::string lost = simulation_->Restore(present, boards_.frames.Latest()->epoch, &stopped);
    if (lost.empty()) {
      helpers_.controllers->TakeStopped();  // already reported
    } else {
      text += "; the current controllers are lost too" + (lost == why ? "" : ": " + lost);
      text += LoseControllers(lost, std::move(stopped));
    }
  }
  return {Error::kNotPossible, text};
}

std::string Stepper::LoseControllers(const std::string& why, std::vector<StoppedController> stopped) {
  const StoppedRobots known = boards_.control.stopped();
  std::erase_if(stopped, [&known](const StoppedController& one) {
    const auto found = known.find(one.robot);
    return found != known.end() && found->second.by == "controller";
  });
  if (stopped.empty()) {
    const std::vector<SceneRobot>& robots = simulation_->scene().robots;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (!robots[i].entry.controller.empty()) helpers_.controllers->Stop(static_cast<int>(i), why);
    }
    helpers_.controllers->Stop(kSupervisor, why);
    stopped = helpers_.controllers->TakeStopped();
  }
  const bool ended = ended_;
  NoteStoppedControllers(stopped, frame().step);
  if (ended_ && !ended) NotifyEnded();
  if (stopped.empty()) return {};
  const std::string more =
      stopped.size() == 1 ? " stands" : fmt::format(" and {} more stand", stopped.size() - 1);
  return "; " + stopped.front().robot + more + " now: reset or load a scenario";
}

void Stepper::InstallState(const SavedState& state, StepEnd end) {
  if (duration_ && frame().time >= *duration_) duration_.reset();
  Install(end, &state);
  history_.Clear();
  std::istringstream warnings(state.warning);
  for (std::string line; std::getline(warnings, line);) AddEvent("warning", line);
}

EditResult Stepper::Apply(const edit::SetMode& set) {
  mode_ = set.mode;
  const Nanoseconds now = clock_.Now();
  boards_.commands.SetMode(mode_, now);
  rate_.Reset();
  RestartPace(now);
  return {};
}

EditResult Stepper::Apply(const edit::SetStep& set) {
  step_length_ = set.step;
  RestartPace(clock_.Now());
  return {};
}

EditResult Stepper::Apply(const edit::SetSpeed& set) {
  speeds_[static_cast<std::size_t>(mode_)] = set.factor;
  rate_.Reset();
  RestartPace(clock_.Now());
  return {};
}

EditResult Stepper::Apply(const edit::SetParticipants& set) {
  const Verdict verdict = boards_.commands.SetParticipants(set.names, clock_.Now());
  return {verdict.error, verdict.text};
}

EditResult Stepper::Apply(const edit::StopAll&) {
  boards_.commands.StopAll();
  return {};
}

EditResult Stepper::Apply(const edit::TuneJoints& tuning) {
  if (std::string why = simulation_->Tune(tuning); !why.empty()) return {Error::kOutOfRange, std::move(why)};
  boards_.frames.Publish(simulation_->frame());
  return {};
}

EditResult Stepper::Apply(const edit::UnloadController& unload) {
  const int robot = simulation_->scene().FindRobot(unload.robot);
  if (robot < 0) return {Error::kNoSuchName, "there is no robot " + unload.robot};
  if (helpers_.controllers != nullptr) helpers_.controllers->Unload(robot);
  boards_.commands.SetDriven(static_cast<std::size_t>(robot), "", clock_.Now());
  return {};
}

}  // namespace coopdyn
