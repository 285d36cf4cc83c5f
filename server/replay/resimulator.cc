// SPDX-License-Identifier: MIT
#include "server/replay/resimulator.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "server/base/printable.h"
#include "server/render/picture_maker.h"
#include "server/sensing/channel_filters.h"

namespace coopdyn {

namespace {

constexpr std::uint64_t kEpoch = 1;
constexpr int kMaxStoppedNamed = 5;

/// The first controller of `scene` whose file does not exist, by its name in the scenario; empty if none.
std::string MissingController(const Scene& scene) {
  for (const ControllerChoice* choice : ControllersOf(scene)) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(choice->file, error)) return choice->name;
  }
  return {};
}

/// The errors of `diagnostics` in one line.
std::string Errors(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& one : diagnostics.all()) {
    if (one.level == Diagnostic::Level::kError) text += (text.empty() ? "" : "; ") + ToString(one);
  }
  return text;
}

}  // namespace

std::string OtherOrigin(const RunHeader& header) {
  std::string text;
  const auto add = [&text](const std::string& other) { text += (text.empty() ? "made " : ", ") + other; };
  if (header.build != BuildId()) {
    const std::string version = header.version.empty() ? "" : "version " + header.version + ", ";
    add("by another build (" + version + header.build + ")");
  }
  const std::vector<PluginHash> here = LibrariesHere();
  for (const PluginHash& one : header.libraries) {
    const auto same = [&one](const PluginHash& mine) {
      return mine.name == one.name && mine.hash == one.hash;
    };
    if (std::ranges::none_of(here, same)) add("with another " + one.name);
  }
  const char* const advice =
      text.empty() ? "; with the same build and libraries only a controller of yours computes otherwise there"
                   : "; repeat it with that build and those libraries (coopdyn info lists them)";
  if (!header.cpu.empty() && header.cpu != CpuName()) add("on another processor (" + header.cpu + ")");
  return text.empty() ? text : Printable(text) + advice;
}

std::vector<std::string> OtherPlugins(const RunHeader& header, const Scene& scene) {
  std::vector<std::string> lines;
  std::set<std::string> known;
  for (const ControllerChoice* choice : ControllersOf(scene)) {
    if (!known.insert(choice->name).second) continue;
    const auto recorded = std::ranges::find(header.controllers, choice->name, &PluginHash::name);
    if (recorded == header.controllers.end()) continue;
    const std::string now = FileHash(choice->file);
    if (now == recorded->hash) continue;
    lines.push_back(Printable("controller " + choice->name + " is not the one that was recorded (hash " +
                              recorded->hash + ", now " + (now.empty() ? "unreadable" : now) + ")"));
  }
  return lines;
}

Resimulator::Resimulator(std::string file, const RunHeader& header, const ReplayServices& services)
    : file_(std::move(file)), header_(header), services_(services) {}

Resimulator::~Resimulator() = default;

void Resimulator::Warn(const std::string& line) {
  if (warning_.find(line) != std::string::npos) return;
  warning_ += (warning_.empty() ? "" : "\n") + line;
}

DrawPictures Resimulator::DrawHere() {
  std::string error;  // the program rejected a wrong renderer name at its start
  const auto maker = std::make_shared<PictureMaker>(RendererFromEnvironment(RendererKind::kAuto, error));
  return [maker](std::span<const PictureWanted> wanted) {
    std::string missing;
    for (const PictureWanted& one : wanted) {
      ImageRequest request;
      request.shot = one.shot;
      request.format = ImageFormat::kRgb;
      const ImageResult drawn = maker->Make(*one.shot.frame, request);
      if (drawn.error.empty() && drawn.bytes->size() == one.rgb.size()) {
        std::ranges::copy(*drawn.bytes, one.rgb.begin());
      } else {
        std::ranges::fill(one.rgb, std::uint8_t{0});
        missing = drawn.error;
      }
    }
    return missing;
  };
}

bool Resimulator::BuildWithHost(const std::shared_ptr<const Scene>& scene, std::uint64_t seed,
                                std::string& why) {
  if (const std::string name = MissingController(*scene); !name.empty()) {
    why = "controller " + name + " is not found";
    return false;
  }
  if (host_ == nullptr) {
    host_ = std::make_unique<ControllerHost>(services_.controllers, services_.clock, services_.logger,
                                             services_.pool, DrawHere());
  }
  for (const std::string& line : OtherPlugins(header_, *scene)) Warn(line);
  Diagnostics diagnostics;
  simulation_ = Simulation::Build(scene, seed, kEpoch, {&services_.pool, host_.get(), AdvanceFilters},
                                  services_.clock, diagnostics);
  why = Errors(diagnostics);
  return simulation_ != nullptr;
}

bool Resimulator::GiveUpControllers(const std::shared_ptr<const Scene>& scene, std::uint64_t seed,
                                    const std::string& why) {
  const auto is_driven = [](const SceneRobot& robot) { return !robot.entry.controller.empty(); };
  if (!header_.what.controllers && std::ranges::any_of(scene->robots, is_driven)) {
    error_ = file_ + ": " + why +
             "; the recording has no set-points of controllers (controllers was not among --record-what), so "
             "it cannot be repeated without: put the controller that ran on the search path, or name its "
             "folder with --scenarios DIR";
    return false;
  }
  simulation_.reset();
  host_.reset();
  controllers_given_up_ = true;
  Diagnostics diagnostics;
  simulation_ = Simulation::Build(scene, seed, kEpoch, {&services_.pool, &recorded_, AdvanceFilters},
                                  services_.clock, diagnostics);
  if (simulation_ == nullptr) {
    error_ = file_ + ": its world cannot be built: " + Errors(diagnostics);
    return false;
  }
  Warn(why + ": the set-points of controllers are taken from the recording, not computed again");
  return true;
}

bool Resimulator::Build(const std::shared_ptr<const Scene>& scene, std::uint64_t seed) {
  simulation_.reset();
  if (!ControllersOf(*scene).empty()) {
    std::string why = "controllers are given up";
    if (!controllers_given_up_ && BuildWithHost(scene, seed, why)) return true;
    return GiveUpControllers(scene, seed, why);
  }
  host_.reset();
  Diagnostics diagnostics;
  simulation_ = Simulation::Build(scene, seed, kEpoch, {&services_.pool, nullptr, AdvanceFilters},
                                  services_.clock, diagnostics);
  if (simulation_ == nullptr) error_ = file_ + ": its world cannot be built: " + Errors(diagnostics);
  return simulation_ != nullptr;
}

bool Resimulator::Restore(const SavedStatePtr& state, std::uint64_t scene_number) {
  const std::shared_ptr<const Scene>& scene = state->frame->scene;
  const bool same = simulation_ != nullptr && simulation_->scene().scenario == scene->scenario;
  if (!same && !Build(scene, state->frame->seed)) return false;
  std::string why = simulation_->Restore(*state, kEpoch);
  if (!why.empty()) {
    if (!GiveUpControllers(scene, state->frame->seed, why)) return false;
    why = simulation_->Restore(*state, kEpoch);
  }
  if (!why.empty()) {
    error_ = file_ + ": its state cannot be restored: " + why;
    return false;
  }
  if (host_ != nullptr) host_->TakeStopped();  // drop controllers that had stopped in the run, too
  scene_number_ = scene_number;
  mode_ = state->mode;
  paused_ = state->paused;
  in_force_.clear();
  for (const ChannelState& channel : state->frame->channels) in_force_.push_back(channel.setpoint);
  commanded_.assign(scene->actuators.size(), 0);
  ListComputed();
  return true;
}

void Resimulator::ListComputed() {
  const Scene& scene = simulation_->scene();
  computed_.assign(scene.robots.size(), 0);
  if (host_ == nullptr) return;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    computed_[i] = scene.robots[i].entry.controller.empty() ? 0 : 1;
  }
  for (const int robot : host_->Unloaded()) computed_[static_cast<std::size_t>(robot)] = 0;
}

void Resimulator::StopChannels(std::size_t robot) {
  const SceneRobot& of = simulation_->scene().robots[robot];
  for (int i = of.first_channel; i < of.first_channel + of.channel_count; ++i) {
    Setpoint& setpoint = in_force_[static_cast<std::size_t>(i)];
    setpoint = setpoint.stopped();
  }
}

void Resimulator::SetInputs(std::vector<RunInput> inputs) {
  inputs_ = std::move(inputs);
  next_input_ = 0;
}

void Resimulator::Apply(const RunInput& input) {
  const Scene& scene = simulation_->scene();
  if (const auto* set = As<edit::SetMode>(input.what)) {
    mode_ = set->mode;
  } else if (As<edit::StopAll>(input.what) != nullptr) {
    // The recorded steps contain the stop too, except for robots whose controller was unloaded before the
    // recording began.
    for (std::size_t i = 0; i < computed_.size() && !controllers_given_up_; ++i) {
      if (computed_[i] == 0) StopChannels(i);
    }
  } else if (const auto* unload = As<edit::UnloadController>(input.what)) {
    const int robot = scene.FindRobot(unload->robot);
    if (robot < 0) return;
    StopChannels(static_cast<std::size_t>(robot));
    if (host_ != nullptr) host_->Unload(robot);
    ListComputed();
  } else if (const auto* tuning = As<edit::TuneJoints>(input.what)) {
    if (const std::string why = simulation_->Tune(*tuning); !why.empty()) {
      Warn("step " + std::to_string(frame()->step) + ": joints are not tuned: " + why);
    }
  } else if (const auto* change = As<WorldChange>(input.what)) {
    Change(*change);
  } else if (const auto* stopped = As<ControllerStopped>(input.what)) {
    const int robot = scene.FindRobot(stopped->robot);
    const ControllerChoice& supervisor = scene.scenario->simulation.supervisor;
    const bool supervises = !supervisor.empty() && stopped->robot == SupervisorName(supervisor);
    if ((robot < 0 && !supervises) || host_ == nullptr) return;
    host_->Stop(supervises ? kSupervisor : robot, stopped->why);
    host_->TakeStopped();
  }
}

void Resimulator::Supervise(std::span<const RunInput> inputs) {
  for (const RunInput& input : inputs) {
    if (IsSupervisors(input)) Change(*As<WorldChange>(input.what));
  }
}

bool Resimulator::ChangesWorld() const {
  for (std::size_t i = next_input_; i < inputs_.size() && inputs_[i].step <= frame()->step; ++i) {
    if (inputs_[i].step == frame()->step && As<WorldChange>(inputs_[i].what) != nullptr) return true;
  }
  return false;
}

void Resimulator::Change(WorldChange change) {
  const std::shared_ptr<const Scene> before = frame()->scene;
  WorldChange ignored;
  if (const std::string why = simulation_->Change(change, ignored); !why.empty()) {
    return Warn("step " + std::to_string(frame()->step) + ": the world is not changed (" + change.label +
                "): " + why);
  }
  const Scene& scene = *frame()->scene;
  in_force_ = InChannelsOf(scene, *before, in_force_, Setpoint());
  commanded_.assign(scene.actuators.size(), 0);
  ListComputed();
  if (host_ != nullptr) host_->TakeStopped();
}

bool Resimulator::Step(const RecordedStep& step) {
  const Nanoseconds length = step.time - frame()->time;
  const std::string where = file_ + ": step " + std::to_string(step.step);
  if (length < kMinStep || length > kMaxStep) {
    error_ = where + " is damaged: it took " + std::to_string(ToSeconds(length)) +
             " s of simulated time, and a step has 0.0005 s to 0.1 s";
    return false;
  }
  for (; next_input_ < inputs_.size() && inputs_[next_input_].step < step.step; ++next_input_) {
    if (inputs_[next_input_].step == frame()->step) Apply(inputs_[next_input_]);
  }
  scene_number_ = step.scene;
  std::fill(commanded_.begin(), commanded_.end(), std::uint8_t{0});
  for (const CommandRecord& command : step.commands) {
    if (command.channel >= in_force_.size()) {
      error_ = where + " is damaged: it commands a joint that is not there";
      return false;
    }
    const Scene& scene = simulation_->scene();
    const Channel& channel = scene.channels[command.channel];
    const auto robot = static_cast<std::size_t>(channel.robot);
    const RobotModel& model = *scene.robots[robot].entry.model;
    const bool is_wheel =
        channel.control < 0 && model.joints[static_cast<std::size_t>(channel.joint)].joins();
    if (is_wheel && command.setpoint.mode != ControlMode::kVelocity) {
      error_ = where + " is damaged: it commands the wheels of " + scene.robots[robot].entry.name +
               " by positions or efforts";
      return false;
    }
    in_force_[command.channel] = command.setpoint;
    commanded_[ActuatorOf(simulation_->scene(), command.channel)] = command.by_client ? 1 : 0;
  }
  messages_.clear();
  for (const SentMessage& message : step.messages) {
    if (message.robot >= computed_.size()) {
      error_ = where + " is damaged: a robot broadcasts that is not there";
      return false;
    }
    // Controllers send their broadcasts again.
    if (computed_[message.robot] == 0) messages_.push_back(message);
  }
  latched_ = in_force_;
  simulation_->Step(length, {latched_, messages_, commanded_});
  paused_ = false;
  if (host_ != nullptr) {
    for (const StoppedController& stopped : host_->TakeStopped()) {
      if (++stopped_here_ > kMaxStoppedNamed) continue;
      Warn("step " + std::to_string(step.step) + ": " + stopped.robot +
           " stops in the repetition, but did not in the run: " + stopped.why);
    }
  }
  return true;
}

std::string Resimulator::StepTo(RunReader& reader, std::uint64_t step,
                                const std::function<std::string(const RecordedStep&)>& check) {
  const std::uint64_t from = frame()->step;
  SetInputs(reader.Inputs(from, step - 1));
  if (!reader.error().empty()) return reader.error();
  std::string error;
  const bool read = reader.ForEach(from + 1, step, true, [&](const RecordedStep& recorded) {
    if (!Follows(recorded)) {
      error = file_ + ": step " + std::to_string(recorded.step - 1) +
              " was not recorded, and no exact state is after it; the newest one before is that of step " +
              std::to_string(from);
    } else {
      error = Step(recorded) ? check(recorded) : error_;
    }
    return error.empty();
  });
  if (!read) return reader.error();
  if (error.empty() && frame()->step != step) {
    return file_ + ": step " + std::to_string(step) + " was not recorded";
  }
  return error;
}

SavedState Resimulator::Save() const {
  SavedState state = simulation_->Save();
  state.mode = mode_;
  state.paused = paused_;
  return state;
}

}  // namespace coopdyn
