// SPDX-License-Identifier: MIT
#include "server/controllers/controller_host.h"

#include <algorithm>
#include <exception>
#include <map>
#include <set>
#include <utility>

#include "server/base/bytes.h"
#include "server/model/drive.h"

namespace coopdyn {

namespace {

const ControllerChoice& ChoiceOf(const RobotEntry& entry) {
  return entry.controller;
}
const ControllerChoice& ChoiceOf(const SceneRobot& robot) {
  return robot.entry.controller;
}

/// The shared objects of the supervisor and the robots, each once, in order of first use.
template <typename Robots>
std::vector<std::string> FilesOf(const ControllerChoice& supervisor, const Robots& robots) {
  std::vector<std::string> files;
  std::set<std::string> known;
  const auto add = [&](const ControllerChoice& choice) {
    if (!choice.empty() && !choice.file.empty() && known.insert(choice.file).second)
      files.push_back(choice.file);
  };
  add(supervisor);
  for (const auto& robot : robots) add(ChoiceOf(robot));
  return files;
}

constexpr std::uint32_t kStateVersion = 2;
constexpr std::size_t kHeldBytes = 9;  // per channel

}  // namespace

ControllerHost::ControllerHost(ControllerOptions options, const Clock& clock, Logger logger, WorkerPool& pool,
                               DrawPictures draw)
    : options_(WithFlag(std::move(options), interrupted_)),
      clock_(clock),
      logger_(std::move(logger)),
      pool_(pool),
      readings_(pool, std::move(draw)) {}

ControllerHost::~ControllerHost() = default;

ControllerOptions ControllerHost::WithFlag(ControllerOptions options, const std::atomic<bool>& interrupted) {
  options.interrupted = &interrupted;
  if (options.launcher == nullptr) options.launcher = std::make_shared<ChildLauncher>(options.program);
  return options;
}

std::unique_ptr<ControllerSet> ControllerHost::SetOf(std::vector<std::string> files) {
  std::unique_ptr<ControllerSet> set = std::move(checked_);
  const auto same = [](const LoadedController& loaded, const std::string& file) {
    return loaded.file == file;
  };
  if (set && set->is_fresh() &&
      std::equal(set->loaded().begin(), set->loaded().end(), files.begin(), files.end(), same)) {
    return set;
  }
  return std::make_unique<ControllerSet>(std::move(files), options_, clock_, logger_, pool_);
}

void ControllerHost::Check(const Scenario& scenario, Diagnostics& diagnostics) {
  const ControllerChoice& supervisor = scenario.simulation.supervisor;
  std::vector<std::string> files = FilesOf(supervisor, scenario.robots);
  if (files.empty()) return;
  // In-process, dlopen() returns a loaded object instead of the new file until it is unloaded.
  stale_ = options_.in_process && set_ && !set_->is_fresh();
  checked_ = SetOf(std::move(files));
  // All robots of a swarm share a line: report each text once per line.
  std::set<std::pair<int, std::string>> said;
  const auto check = [&](const ControllerChoice& choice, const char* otherwise, auto faults_of) {
    const int file = checked_->IndexOf(choice.file);
    if (choice.empty() || file < 0) return;
    const LoadedController& one = checked_->loaded()[static_cast<std::size_t>(file)];
    if (!one.description) {
      const std::string text = "controller " + choice.name + " " + one.why + "; " + otherwise;
      if (said.emplace(choice.where.line, text).second) diagnostics.Warning(choice.where, text);
      return;
    }
    for (const std::string& text : faults_of(*one.description)) {
      if (said.emplace(choice.where.line, text).second) diagnostics.Error(choice.where, text);
    }
  };
  check(supervisor, "the run will have no supervisor",
        [&](const ControllerDescription& one) { return one.SupervisorFaults(supervisor); });
  for (const RobotEntry& entry : scenario.robots) {
    check(entry.controller, "its robots will stand",
          [&](const ControllerDescription& one) { return one.Faults(entry); });
  }
}

void ControllerHost::List(const Scene& scene) {
  if (set_) ended_cpu_s_ += set_->child_cpu_s();
  set_.reset();
  if (std::exchange(stale_, false)) checked_.reset();
  driven_.clear();
  driven_of_slot_.clear();
  stopped_.clear();
  supervision_ = {};
  if (const ControllerChoice& supervisor = scene.scenario->simulation.supervisor; !supervisor.empty()) {
    world_.entry.model = std::make_shared<const RobotModel>();
    world_.entry.controller = supervisor;
    Driven& driven = driven_.emplace_back();
    driven.robot = kSupervisor;
    driven.name = SupervisorName(supervisor);
    driven.controller = supervisor.name;
    driven.options = supervisor.options;
  }
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const SceneRobot& robot = scene.robots[i];
    if (robot.entry.controller.empty()) continue;
    Driven driven;
    driven.id = robot.id;
    driven.robot = static_cast<int>(i);
    driven.name = robot.entry.name;
    driven.controller = robot.entry.controller.name;
    driven.options = robot.entry.controller.options;
    driven.first_channel = static_cast<std::size_t>(robot.first_channel);
    driven.channel_count = static_cast<std::size_t>(robot.channel_count);
    if (const ActuatorModel* drive = robot.entry.model->drive_actuator()) {
      driven.drive = *robot.entry.model->drive();
      driven.wheels = robot.entry.model->FirstChannel(*drive);
    }
    driven_.push_back(std::move(driven));
  }
}

void ControllerHost::Configure(const FramePtr& frame) {
  List(*frame->scene);
  Create(frame);
}

void ControllerHost::Create(const FramePtr& frame) {
  scene_ = frame->scene;
  std::vector<std::string> files = FilesOf(scene_->scenario->simulation.supervisor, scene_->robots);
  std::vector<ControlledRobot> robots;
  try {
    if (!files.empty()) set_ = SetOf(std::move(files));
    for (std::uint32_t i = 0; i < driven_.size(); ++i) {
      Driven& driven = driven_[i];
      if (driven.status != Status::kDrives) continue;
      const SceneRobot& robot = RobotOf(driven);
      const ControllerChoice& choice = robot.entry.controller;
      const int file = set_ ? set_->IndexOf(choice.file) : -1;
      if (file < 0) {
        Stop(driven, "was not found");
        continue;
      }
      const LoadedController& loaded = set_->loaded()[static_cast<std::size_t>(file)];
      if (!loaded.description) {
        Stop(driven, loaded.why);
        continue;
      }
      const std::vector<std::string> faults = driven.supervises()
                                                  ? loaded.description->SupervisorFaults(choice)
                                                  : loaded.description->Faults(robot.entry);
      if (!faults.empty()) {
        Stop(driven, "was not started: " + faults.front());
        continue;
      }
      if (driven.restored && driven.restored->size() != loaded.description->state_size) {
        Stop(driven, "is not the one that saved its state: their state_size differs");
        continue;
      }
      driven.slot = static_cast<std::uint32_t>(robots.size());
      driven.readings = driven.supervises() ? std::uint32_t{COOPDYN_WORLD} : loaded.description->readings;
      driven.sensors = loaded.description->SensorsOf(*robot.entry.model);
      driven_of_slot_.push_back(i);
      std::span<const std::byte> state;
      if (driven.restored) state = *driven.restored;
      robots.push_back({static_cast<std::uint32_t>(file), &robot, loaded.description->Values(choice), state});
    }
    if (set_) StopCasualties(set_->Create(robots, *frame));
  } catch (const std::exception& exception) {
    for (Driven& driven : driven_) Stop(driven, std::string("could not be started: ") + exception.what());
  }
  for (Driven& driven : driven_) driven.restored.reset();
  ListItems();
}

void ControllerHost::Rebind(const std::shared_ptr<const Scene>& scene) {
  std::map<RobotId, int> index;
  for (std::size_t i = 0; i < scene->robots.size(); ++i) index[scene->robots[i].id] = static_cast<int>(i);
  for (Driven& driven : driven_) {
    if (driven.supervises()) continue;
    const auto found = index.find(driven.id);
    driven.robot = found == index.end() ? -1 : found->second;
    if (driven.robot < 0) continue;
    driven.first_channel =
        static_cast<std::size_t>(scene->robots[static_cast<std::size_t>(driven.robot)].first_channel);
  }
  scene_ = scene;
  ListItems();
}

void ControllerHost::ListItems() {
  items_.clear();
  wanted_.clear();
  for (const std::uint32_t index : driven_of_slot_) {
    const Driven& driven = driven_[index];
    if (driven.status != Status::kDrives || driven.gone()) continue;
    items_.push_back(driven.slot);
    wanted_.push_back({driven.slot, driven.robot, driven.readings, driven.sensors});
  }
}

void ControllerHost::StopCasualties(std::span<const Casualty> casualties) {
  if (casualties.empty()) return;
  for (const Casualty& casualty : casualties) Stop(driven_[driven_of_slot_[casualty.item]], casualty.why);
  ListItems();
}

void ControllerHost::Stop(Driven& driven, const std::string& why) {
  if (driven.status != Status::kDrives) return;
  driven.status = Status::kStopped;
  driven.why = "controller " + driven.controller + " " + why;
  stopped_.push_back({driven.name, driven.why, interrupted_});
}

void ControllerHost::Unload(int robot) {
  for (Driven& driven : driven_) {
    if (driven.robot != robot) continue;
    if (driven.status == Status::kDrives && set_) set_->Drop(driven.slot);
    driven.status = Status::kUnloaded;
  }
  ListItems();
}

std::vector<int> ControllerHost::Unloaded() const {
  std::vector<int> robots;
  for (const Driven& driven : driven_) {
    if (driven.status == Status::kUnloaded && driven.robot >= 0) robots.push_back(driven.robot);
  }
  return robots;
}

void ControllerHost::Stop(int robot, const std::string& why) {
  for (Driven& driven : driven_) {
    if (driven.robot != robot || driven.gone() || driven.status != Status::kDrives) continue;
    if (set_) set_->Drop(driven.slot);
    driven.status = Status::kStopped;
    driven.why = why;
    stopped_.push_back({driven.name, driven.why});
  }
  ListItems();
}

std::vector<StoppedController> ControllerHost::TakeStopped() {
  return std::exchange(stopped_, {});
}

ControllerCost ControllerHost::slowest() const {
  return set_ ? set_->slowest() : ControllerCost();
}

void ControllerHost::Rest() {
  if (set_) set_->Rest();
}

double ControllerHost::child_cpu_s() const {
  return ended_cpu_s_ + (set_ ? set_->child_cpu_s() : 0) + (checked_ ? checked_->child_cpu_s() : 0);
}

void ControllerHost::Revise(const FramePtr& frame) {
  std::map<RobotId, Driven> before;
  bool same = true;
  std::size_t count = 0;
  std::map<RobotId, const SceneRobot*> robots;
  for (const Driven& driven : driven_) {
    if (!driven.supervises()) break;
    robots[driven.id] = &world_;
    ++count;
  }
  for (const SceneRobot& robot : frame->scene->robots) {
    if (robot.entry.controller.empty()) continue;
    robots[robot.id] = &robot;
    ++count;
  }
  same = count == driven_.size();
  for (Driven& driven : driven_) {
    const auto found = robots.find(driven.id);
    const ControllerChoice* now = found == robots.end() ? nullptr : &found->second->entry.controller;
    const bool stays = now != nullptr && now->name == driven.controller && now->options == driven.options;
    same &= stays && (driven.supervises() || found->second->entry.name == driven.name);
    if (!stays) continue;
    Driven kept = driven;
    if (driven.status == Status::kDrives && set_) {
      const std::span<const std::byte> state = set_->StateOf(driven.slot);
      kept.restored.emplace(state.begin(), state.end());
    }
    before.emplace(driven.id, std::move(kept));
  }
  if (same) return Rebind(frame->scene);
  std::vector<StoppedController> told = std::move(stopped_);
  List(*frame->scene);
  for (Driven& driven : driven_) {
    const auto found = before.find(driven.id);
    if (found == before.end()) continue;
    driven.status = found->second.status;
    driven.why = found->second.why;
    driven.restored = std::move(found->second.restored);
    driven.held = std::move(found->second.held);
  }
  Create(frame);
  stopped_.insert(stopped_.begin(), told.begin(), told.end());
}

// Format of Save() and Restore(), stored in keyframes, little-endian:
//   u32 version, u32 count, then for each robot with a controller by increasing id:
//   u32 id, u8 status, u32 size of the controller's name, name, u32 size of the reason, reason, u32 size,
//   state, since version 2 u32 count, then for each channel that is held f64 reference, u8 mode

std::vector<std::byte> ControllerHost::Save() const {
  std::vector<std::byte> saved;
  ByteWriter writer(saved);
  writer.Number(kStateVersion);
  writer.List(driven_, 0, [&](const Driven& driven) {
    writer.Number(driven.id.value);
    writer.Word(driven.status, Status::kUnloaded);
    writer.Text(driven.controller);
    writer.Text(driven.why);
    const bool drives = driven.status == Status::kDrives && set_;
    writer.Bytes(drives ? set_->StateOf(driven.slot) : std::span<const std::byte>());
    writer.List(driven.held, kHeldBytes, [&writer](const Setpoint& one) {
      writer.Number(one.reference);
      writer.Word(one.mode, ControlMode::kPwm);
    });
  });
  return saved;
}

bool ControllerHost::Restore(const FramePtr& frame, std::span<const std::byte> saved) {
  List(*frame->scene);
  ByteReader reader(saved);
  const std::uint64_t version = reader.Low(4);
  reader.Require(version >= 1 && version <= kStateVersion);
  reader.Require(reader.Low(4) == driven_.size());
  std::vector<Driven> restored = driven_;
  for (Driven& driven : restored) {
    std::string controller;
    reader.Require(reader.Low(4) == driven.id.value);
    reader.Word(driven.status, Status::kUnloaded);
    reader.Text(controller);
    reader.Require(controller == driven.controller);
    reader.Text(driven.why);
    reader.Bytes(driven.restored.emplace());
    if (version < 2) continue;
    reader.List(driven.held, kHeldBytes, [&reader](Setpoint& one) {
      reader.Finite(one.reference);
      reader.Word(one.mode, ControlMode::kPwm);
    });
  }
  const bool fits = reader.finished();
  if (fits) driven_ = std::move(restored);
  std::vector<StoppedController> before;
  for (const Driven& driven : driven_) {
    if (driven.status == Status::kStopped) before.push_back({driven.name, driven.why});
  }
  Create(frame);
  stopped_.insert(stopped_.end(), before.begin(), before.end());
  return fits;
}

}  // namespace coopdyn
