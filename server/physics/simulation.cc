// SPDX-License-Identifier: MIT
#include "server/physics/simulation.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "server/physics/world.h"
#include "server/state/joint_tuning.h"

namespace coopdyn {

namespace {

bool HasFilters(const Scene& scene) {
  const auto is_filtered = [](const SensorModel& sensor) {
    const auto* const channel = std::get_if<ChannelModel>(&sensor.kind);
    return channel != nullptr && channel->remembers();
  };
  return std::ranges::any_of(scene.robots, [&](const SceneRobot& robot) {
    return std::ranges::any_of(robot.entry.model->sensors, is_filtered);
  });
}

}  // namespace

std::unique_ptr<Simulation> Simulation::Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                              std::uint64_t epoch, const StepHelpers& helpers,
                                              const Clock& clock, Diagnostics& diagnostics) {
  const int errors = diagnostics.errors();
  if (helpers.controllers != nullptr) {
    helpers.controllers->Check(*scene->scenario, diagnostics);
  } else {
    const auto refuse = [&diagnostics](const ControllerChoice& choice) {
      if (!choice.empty())
        diagnostics.Error(choice.where, "controllers are not loaded here: leave the line out");
    };
    refuse(scene->scenario->simulation.supervisor);
    for (const SceneRobot& robot : scene->robots) refuse(robot.entry.controller);
  }
  if (diagnostics.errors() > errors) return nullptr;
  auto world = PhysicsWorld::Build(scene, seed, diagnostics, helpers.pool);
  if (world == nullptr) return nullptr;
  return std::unique_ptr<Simulation>(
      new Simulation(std::move(scene), std::move(world), seed, epoch, helpers, clock));
}

Simulation::Simulation(std::shared_ptr<const Scene> scene, std::unique_ptr<PhysicsWorld> world,
                       std::uint64_t seed, std::uint64_t epoch, const StepHelpers& helpers,
                       const Clock& clock)
    : helpers_(helpers), clock_(clock), world_(std::move(world)), seed_(seed), epoch_(epoch) {
  Use(std::move(scene));
  const std::shared_ptr<Frame> frame = MakeFrame();
  scores_.Begin(*frame);
  start_ = frame_ = frame;
}

Simulation::~Simulation() = default;

std::vector<FrozenBody> Simulation::TakeFrozen() {
  return world_->TakeFrozen();
}

std::vector<std::string> Simulation::TakeUnsolved() {
  return world_->TakeUnsolved();
}

std::shared_ptr<Frame> Simulation::MakeFrame() {
  std::shared_ptr<Frame> frame = frames_.Take();
  frame->epoch = epoch_;
  frame->step = step_;
  frame->time = time_;
  frame->step_length = step_length_;
  frame->seed = seed_;
  frame->scene = scene_;
  world_->Fill(*frame);
  frame->messages = messages_;
  samples_.AddTo(*frame);
  frame->scores.clear();
  return frame;
}

void Simulation::Use(std::shared_ptr<const Scene> scene) {
  scene_ = std::move(scene);
  has_controllers_ = !scene_->scenario->simulation.supervisor.empty();
  has_filters_ = HasFilters(*scene_);
  assert(!has_filters_ || helpers_.advance_filters != nullptr);
  message_steps_ = 0;
  for (const SceneRobot& robot : scene_->robots) {
    has_controllers_ |= !robot.entry.controller.empty();
    message_steps_ = std::max<std::uint64_t>(message_steps_,
                                             static_cast<unsigned>(robot.entry.model->message_delay_steps()));
  }
}

void Simulation::Take(const Frame& frame) {
  if (frame.scene == scene_) {
    world_->Restore(frame);
  } else {
    world_->Rebuild(frame.scene, frame);
    Use(frame.scene);
  }
}

void Simulation::SetStepLength(Nanoseconds length) {
  step_length_ = length;
  if (step_ != 0 || frame_->step_length == length) return;
  const std::shared_ptr<Frame> frame = MakeFrame();
  scores_.Begin(*frame);
  frame_ = frame;
}

void Simulation::StartControllers() {
  if (helpers_.controllers != nullptr) helpers_.controllers->Configure(frame_);
}

void Simulation::Restart(std::uint64_t seed, std::uint64_t epoch) {
  seed_ = seed;
  epoch_ = epoch;
  step_ = 0;
  time_ = 0;
  messages_.clear();
  if (start_->scene != scene_) Take(*start_);
  world_->Restart(*start_, seed);
  const std::shared_ptr<Frame> frame = MakeFrame();
  scores_.Begin(*frame);
  frame_ = frame;
  StartControllers();
}

std::string Simulation::Restore(const SavedState& state, std::uint64_t epoch,
                                std::vector<StoppedController>* stopped) {
  const Frame& from = *state.frame;
  seed_ = from.seed;
  epoch_ = epoch;
  step_ = from.step;
  time_ = from.time;
  step_length_ = from.step_length;
  messages_ = from.messages;
  Take(from);
  samples_.Continue(from, epoch);
  const std::shared_ptr<Frame> frame = MakeFrame();
  frame->channels = from.channels;
  frame->commanded = from.commanded;
  const bool fits = scores_.Restore(*frame, state.scores);
  frame_ = frame;
  if (!fits) return "its scores do not match the scenario's";
  return helpers_.controllers == nullptr ? "" : RestoreControllers(state.controllers, stopped);
}

std::string Simulation::RestoreControllers(std::span<const std::byte> saved,
                                           std::vector<StoppedController>* told) {
  ControllerDriver& controllers = *helpers_.controllers;
  bool fits = true;
  if (saved.empty()) {
    controllers.Configure(frame_);
  } else {
    fits = controllers.Restore(frame_, saved);
  }
  if (!has_controllers_) return {};
  // Controllers that accepted the state save the same bytes again, because none has run yet. A driver that
  // saves nothing replaces the controllers (a repetition reads their outputs from the recording).
  const std::vector<std::byte> now = controllers.Save();
  if (fits && (now.empty() || std::ranges::equal(now, saved))) return {};
  if (saved.empty()) return "the states of its controllers were not saved";
  const std::vector<StoppedController> stopped = controllers.TakeStopped();
  if (told != nullptr) *told = stopped;
  if (!fits || stopped.empty()) return "the loaded controllers reject the saved state";
  return stopped.front().why + " (" + stopped.front().robot + ")";
}

std::string Simulation::Tune(const edit::TuneJoints& tuning) {
  std::vector<JointControl> controls = world_->controls();
  if (std::string why = TuneControls(tuning, *scene_, controls); !why.empty()) return why;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    if (controls[i] != world_->controls()[i]) world_->Tune(i, controls[i]);
  }
  const std::shared_ptr<Frame> frame = MakeFrame();
  frame->commanded = frame_->commanded;
  frame->revision = frame_->revision + 1;
  scores_.Refit(*frame);
  frame_ = frame;
  return {};
}

SavedState Simulation::Save() const {
  SavedState state;
  state.frame = frame_;
  state.scores = scores_.Save();
  if (has_controllers_ && helpers_.controllers != nullptr) state.controllers = helpers_.controllers->Save();
  return state;
}

void Simulation::TakeMessages(std::span<const SentMessage> sent) {
  const std::uint64_t oldest = step_ + 1 - std::min(step_ + 1, message_steps_);
  std::erase_if(messages_, [oldest](const SentMessage& message) { return message.step < oldest; });
  messages_.insert(messages_.end(), sent.begin(), sent.end());
}

const FramePtr& Simulation::Step(Nanoseconds length, const StepInputs& inputs) {
  TakeMessages(inputs.messages);
  if (has_controllers_ && helpers_.controllers != nullptr) {
    const auto first = static_cast<std::ptrdiff_t>(messages_.size() - inputs.messages.size());
    helpers_.controllers->Step(frame_, inputs.setpoints, messages_);
    std::stable_sort(messages_.begin() + first, messages_.end(),
                     [](const SentMessage& a, const SentMessage& b) { return a.robot < b.robot; });
  }
  const int substeps = std::max(DefaultSubsteps(length), scene_->scenario->simulation.substeps.value_or(1));
  const Nanoseconds began = clock_.Now();
  world_->Step(length, substeps, inputs.setpoints, {seed_, step_ + 1});
  const Nanoseconds stepped = clock_.Now();
  ++step_;
  time_ += length;
  step_length_ = length;
  const std::shared_ptr<Frame> frame = MakeFrame();
  frame->commanded.assign(inputs.commanded.begin(), inputs.commanded.end());
  frame->commanded.resize(scene_->actuators.size());
  if (has_filters_) {
    helpers_.advance_filters(*frame_, *frame);
    world_->KeepMeasured(frame->measured);
  }
  scores_.AddTo(*frame);
  frame_ = frame;
  times_.physics += stepped - began;
  times_.publish += clock_.Now() - stepped;
  return frame_;
}

}  // namespace coopdyn
