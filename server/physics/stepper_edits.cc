// SPDX-License-Identifier: MIT
// What each edit does to the run, between two steps, by the holder of the baton.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/physics/stepper.h"

namespace coopdyn {

namespace {

EditResult Refusal(Error error, std::string text) {
  return {error, std::move(text), nullptr};
}

}  // namespace

void Stepper::ApplyEdits() {
  for (Edit& edit : boards_.edits.TakeAll()) {
    EditResult result =
        std::visit([this](const auto& action) REQUIRES(baton_) { return Apply(action); }, edit.action);
    result.frame = boards_.frames.Latest();
    PublishStatus(clock_.Now(), true);
    const bool waits = std::holds_alternative<edit::Step>(edit.action) && result.error == Error::kOk;
    if (edit.done && !waits) edit.done(result);
  }
}

EditResult Stepper::Apply(const edit::Run&) {
  if (ended_) return Refusal(Error::kNotPossible, "the run has reached its duration: reset starts it again");
  if (paused_) {
    paused_ = false;
    allowed_steps_ = 0;
    RestartPace(clock_.Now());
  }
  return {};
}

EditResult Stepper::Apply(const edit::Pause&) {
  paused_ = true;
  return {};
}

EditResult Stepper::Apply(const edit::Step& step) {
  if (ended_) return Refusal(Error::kNotPossible, "the run has reached its duration: reset starts it again");
  if (!paused_) return Refusal(Error::kNotPossible, "step works only while paused: send pause first");
  if (allowed_steps_ == 0) RestartPace(clock_.Now());
  allowed_steps_ += step.steps;
  boards_.commands.WaitSteps(static_cast<int>(allowed_steps_), step.done);
  return {};
}

EditResult Stepper::Apply(const edit::Reset& reset) {
  return Rebuild(scene_->scenario, reset.seed.value_or(seed_), StepEnd::kReset);
}

EditResult Stepper::Apply(const edit::Load& load) {
  const std::uint64_t seed = options_.seed.value_or(load.scenario->simulation.seed);
  return Rebuild(load.scenario, seed, StepEnd::kLoad);
}

EditResult Stepper::Rebuild(std::shared_ptr<const Scenario> scenario, std::uint64_t seed, StepEnd end) {
  Diagnostics diagnostics;
  auto scene = MakeScene(scenario, scene_->epoch + 1);
  auto world = BuildWorld(scene, seed, diagnostics);
  if (world == nullptr) return Refusal(Error::kMalformed, diagnostics.ToString());
  seed_ = seed;
  if (end == StepEnd::kLoad) {
    if (!options_.mode) mode_ = scenario->simulation.mode.value_or(mode_);
    TakeOptions(scenario->simulation);
  }
  Install(std::move(world), std::move(scene), end);
  return {};
}

std::unique_ptr<PhysicsWorld> Stepper::BuildWorld(const std::shared_ptr<const Scene>& scene,
                                                  std::uint64_t seed, Diagnostics& diagnostics) {
  const int errors = diagnostics.errors();
  if (helpers_.controllers != nullptr) {
    helpers_.controllers->Check(*scene->scenario, diagnostics);
  } else {
    for (const RobotEntry& robot : scene->scenario->robots) {
      if (robot.controller.empty()) continue;
      diagnostics.Error(robot.controller.where, "controllers are not loaded here: leave the line out");
    }
  }
  if (diagnostics.errors() > errors) return nullptr;
  return PhysicsWorld::Build(scene, seed, diagnostics, helpers_.pool);
}

void Stepper::TakeOptions(const SimulationOptions& said) {
  if (const auto step = options_.step ? options_.step : said.step) step_length_ = *step;
  substeps_ = said.substeps;
  std::optional<double>& given = speeds_[static_cast<std::size_t>(mode_)];
  if (said.speed && !options_.speed) given = said.speed;
  const std::optional<double> duration_s = options_.duration_s ? options_.duration_s : said.duration_s;
  duration_.reset();
  if (duration_s) duration_ = std::llround(*duration_s * 1e9);
}

void Stepper::Install(std::unique_ptr<PhysicsWorld> world, std::shared_ptr<const Scene> scene, StepEnd end) {
  world_ = std::move(world);
  scene_ = std::move(scene);
  step_ = 0;
  time_ = 0;
  ended_ = false;
  allowed_steps_ = 0;
  status_.frozen.clear();
  off_floor_.assign(scene_->robots.size(), false);
  chassis_.clear();
  messages_.clear();
  message_steps_ = 0;
  has_deadlines_ = has_controllers_ = false;
  for (const SceneRobot& robot : scene_->robots) {
    chassis_.push_back(static_cast<std::size_t>(robot.first_body));
    has_deadlines_ |= robot.entry.deadline_s.has_value();
    has_controllers_ |= !robot.entry.controller.empty();
    const NeighboursModel& neighbours = robot.entry.model->neighbours;
    const bool hears = neighbours.message_range_m > 0;
    if (hears) message_steps_ = std::max(message_steps_, static_cast<std::uint64_t>(neighbours.delay_steps));
  }
  const Nanoseconds now = clock_.Now();
  const std::shared_ptr<Frame> frame = MakeFrame();
  for (RobotState& robot : frame->robots) robot.setpoint_rad_s = {};
  boards_.frames.Publish(frame);
  boards_.commands.SetMode(mode_, now);
  boards_.commands.Configure(*scene_, end, frame, now);
  if (helpers_.controllers != nullptr) {
    helpers_.controllers->Configure(frame);
    NoteStoppedControllers();
  }
  rate_.Reset();
  RestartPace(now);
  PublishStatus(now, true);
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
  return {verdict.error, verdict.text, nullptr};
}

EditResult Stepper::Apply(const edit::StopAll&) {
  boards_.commands.StopAll();
  return {};
}

EditResult Stepper::Apply(const edit::UnloadController& unload) {
  const int robot = scene_->FindRobot(unload.robot);
  if (robot < 0) return Refusal(Error::kNoSuchName, "there is no robot " + unload.robot);
  if (helpers_.controllers != nullptr) helpers_.controllers->Unload(robot);
  boards_.commands.SetDriven(static_cast<std::size_t>(robot), "", clock_.Now());
  return {};
}

}  // namespace coopdyn
