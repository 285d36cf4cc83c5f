// SPDX-License-Identifier: MIT
// What a step holds: read, decoded, and checked against its scene.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/record/pose_codec.h"
#include "server/record/run_reader_impl.h"
#include "server/record/state_codec.h"

namespace coopdyn {

namespace {

/// So many steps are read before the file is let go again: a writer waits for readers to tidy up its log.
constexpr std::int64_t kStepsInMemory = 500;

enum Column { kStep, kTime, kHash, kScene, kCommands, kMessages, kWheels, kDistances, kTargets, kPoses };

bool AreFinite(const std::vector<WheelStates>& robots) {
  return std::all_of(robots.begin(), robots.end(), [](const WheelStates& robot) {
    return std::isfinite(robot.speed_rad_s[0]) && std::isfinite(robot.speed_rad_s[1]);
  });
}

std::size_t DistanceSensors(const Scene& scene) {
  std::size_t sensors = 0;
  for (const SceneRobot& robot : scene.robots) sensors += robot.entry.model->sector_count();
  return sensors;
}

/// The robots that `records` name are in a scene of `robots` robots.
template <typename Records>
bool KnowsRobots(const Records& records, std::size_t robots) {
  for (const auto& record : records) {
    if (record.robot >= robots) return false;
  }
  return true;
}

std::string KeyframeBefore(std::uint64_t step) {
  return "the keyframe at or before step " + std::to_string(step);
}

}  // namespace

bool RunReader::Impl::Decode(const Statement& row, bool inputs_only, RecordedStep& step) {
  const std::int64_t number = row.integer(kStep);
  const std::string name = "step " + std::to_string(number);
  if (number < 0 || row.integer(kTime) < 0 || row.integer(kScene) < 0) {
    return FailSense("a number, time or scene below 0 of " + name);
  }
  step.step = static_cast<std::uint64_t>(number);
  step.time = row.integer(kTime);
  step.hash = static_cast<std::uint64_t>(row.integer(kHash));
  step.scene = static_cast<std::uint64_t>(row.integer(kScene));
  if (!DecodeCommands(row.blob(kCommands), step.commands)) return FailSense("the commands of " + name);
  if (!DecodeMessages(row.blob(kMessages), step.step, step.messages)) {
    return FailSense("the broadcasts of " + name);
  }
  const bool needs_scene = !inputs_only || scenario != nullptr;
  if (!needs_scene) return true;
  const std::shared_ptr<const Scene> scene = SceneOf(step.scene);
  if (scene == nullptr) return false;
  if (!KnowsRobots(step.commands, scene->robots.size())) return FailSense("the commands of " + name);
  if (!KnowsRobots(step.messages, scene->robots.size())) return FailSense("the broadcasts of " + name);
  return inputs_only || DecodeReadings(row, *scene, step);
}

bool RunReader::Impl::DecodeReadings(const Statement& row, const Scene& scene, RecordedStep& step) {
  const std::string name = " of step " + std::to_string(step.step);
  if (!row.is_null(kWheels)) {
    step.robots.resize(scene.robots.size());
    if (!DecodeWheels(row.blob(kWheels), step.robots) || !AreFinite(step.robots)) {
      return FailSense("the wheels" + name);
    }
  }
  if (!DecodeFloats(row.blob(kDistances), step.distances) ||
      (!step.distances.empty() && step.distances.size() != DistanceSensors(scene))) {
    return FailSense("the distances" + name);
  }
  if (!DecodeFloats(row.blob(kTargets), step.targets) ||
      (!step.targets.empty() && step.targets.size() != 2 * scene.robots.size() * scene.targets.size())) {
    return FailSense("the sighted targets" + name);
  }
  if (row.is_null(kPoses)) return true;
  step.bodies.resize(scene.body_ids.size());
  return DecodePoses(row.blob(kPoses), step.bodies) || FailSense("the poses" + name);
}

std::optional<RecordedStep> RunReader::Read(std::uint64_t step, bool inputs_only) {
  impl_->error.clear();
  return impl_->Guard("step " + std::to_string(step), [&] { return impl_->Read(step, inputs_only); });
}

std::optional<RecordedStep> RunReader::Impl::Read(std::uint64_t step, bool inputs_only) {
  if (step > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return std::nullopt;
  Statement& row = inputs_only ? sql->inputs : sql->whole;
  row.Reset();
  row.Bind(1, static_cast<std::int64_t>(step));
  if (!row.Step()) {
    FailAsReplaced();
    return std::nullopt;
  }
  std::optional<RecordedStep> read(std::in_place);
  if (!Decode(row, inputs_only, *read)) read.reset();
  row.Reset();
  return read;
}

bool RunReader::ForEach(std::uint64_t first, std::uint64_t last, bool inputs_only,
                        const std::function<bool(const RecordedStep&)>& use) {
  impl_->error.clear();
  return impl_->Guard("the steps from " + std::to_string(first) + " on",
                      [&] { return impl_->ForEach(first, last, inputs_only, use); });
}

bool RunReader::Impl::ForEach(std::uint64_t first, std::uint64_t last, bool inputs_only,
                              const std::function<bool(const RecordedStep&)>& use) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (first > kMost) return true;
  const std::string readings = inputs_only ? "" : ", wheels, distances, targets, poses";
  Statement rows = database().Prepare("SELECT step, time_ns, hash, scene, commands, messages" + readings +
                                      " FROM step WHERE step BETWEEN ?1 AND ?2 ORDER BY step LIMIT ?3");
  rows.Bind(2, static_cast<std::int64_t>(std::min(last, kMost)));
  rows.Bind(3, kStepsInMemory);
  auto next = static_cast<std::int64_t>(first);
  for (std::int64_t count = kStepsInMemory; count == kStepsInMemory;) {
    rows.Bind(1, next);
    for (count = 0; rows.Step(); ++count) {
      RecordedStep step;
      if (!Decode(rows, inputs_only, step)) return false;
      // In a damaged file rows may stand anywhere.
      if (rows.integer(kStep) < next) return FailSense("step " + std::to_string(step.step) + " at its place");
      if (!use(step)) return true;
      next = rows.integer(kStep) + 1;
    }
  }
  return true;
}

std::shared_ptr<const Scenario> RunReader::LoadScenario(const SearchPath& path, Diagnostics& diagnostics) {
  Impl& impl = *impl_;
  const RunHeader& header = impl.header;
  impl.library = std::make_unique<RobotLibrary>(path, header.sources);
  impl.scenes.clear();
  impl.scenario = ReadScenario(header.scenario_text, header.scenario_file, *impl.library,
                               header.scenario_file.empty(), diagnostics, header.scenario_seed);
  return impl.scenario;
}

void RunReader::UseScenario(std::shared_ptr<const Scenario> scenario) {
  impl_->library.reset();
  impl_->scenes.clear();
  impl_->scenario = std::move(scenario);
}

std::shared_ptr<const Scene> RunReader::SceneOf(std::uint64_t scene) {
  impl_->error.clear();
  return impl_->Guard("scene " + std::to_string(scene), [&] { return impl_->SceneOf(scene); });
}

std::shared_ptr<const Scene> RunReader::Impl::SceneOf(std::uint64_t scene_number) {
  if (const auto known = scenes.find(scene_number); known != scenes.end()) return known->second;
  const std::string name = "scene " + std::to_string(scene_number);
  if (scenario == nullptr) {
    error = file + ": " + name + " needs the scenario, which has not been loaded";
    return nullptr;
  }
  sql->scene.Reset();
  sql->scene.Bind(1, static_cast<std::int64_t>(scene_number));
  if (!sql->scene.Step()) return FailSense("a step of " + name + ", which is missing"), nullptr;
  const auto model = [this](const std::string& type) -> std::shared_ptr<const RobotModel> {
    for (const RobotEntry& robot : scenario->robots) {
      if (robot.model->type == type) return robot.model;
    }
    if (library == nullptr) return nullptr;
    Diagnostics ignored;
    return library->Get(type, SourceLine{file, 0}, ignored);
  };
  std::shared_ptr<const Scene> scene = DecodeScene(sql->scene.blob(0), scenario, model);
  sql->scene.Reset();
  if (scene == nullptr) return FailSense(name), nullptr;
  scenes.emplace(scene_number, scene);
  return scene;
}

SavedStatePtr RunReader::Keyframe(std::uint64_t step) {
  impl_->error.clear();
  return impl_->Guard(KeyframeBefore(step), [&] { return impl_->Keyframe(step); });
}

SavedStatePtr RunReader::Impl::Keyframe(std::uint64_t step) {
  Statement& row = sql->keyframe;
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  row.Reset();
  row.Bind(1, static_cast<std::int64_t>(std::min(step, kMost)));
  if (!row.Step()) {
    error =
        file + ": " + KeyframeBefore(step) + " is missing: go on from a later time, or copy the file again";
    return nullptr;
  }
  const std::int64_t number = row.integer(0);
  const std::string name = "the keyframe of step " + std::to_string(number);
  SavedStatePtr state;
  Statement& step_row = sql->inputs;
  step_row.Reset();
  step_row.Bind(1, number);
  if (!step_row.Step() || step_row.integer(kScene) < 0) {
    FailSense(name + " without its step");
  } else if (const auto scene = SceneOf(static_cast<std::uint64_t>(step_row.integer(kScene)))) {
    state = DecodeState(row.blob(1), scene);
    const bool fits = state != nullptr && state->frame->step == static_cast<std::uint64_t>(number) &&
                      state->frame->time == step_row.integer(kTime);
    if (!fits) {
      state = nullptr;
      FailSense(name);
    }
  }
  step_row.Reset();
  row.Reset();
  return state;
}

}  // namespace coopdyn
