// SPDX-License-Identifier: MIT
#include "server/record/step_row.h"

#include <algorithm>

#include "server/state/pose_codec.h"

namespace coopdyn {

std::string StepColumns::Select(bool inputs_only, bool has_scores) {
  std::string readings;
  if (!inputs_only) readings = ", channels, distances, targets, poses";
  if (!inputs_only) readings += has_scores ? ", scores" : ", NULL";
  return "SELECT step, time_ns, hash, scene, commands, messages" + readings + " FROM step";
}

bool StepColumns::HasScores(const Database& database) {
  return database.Integer("SELECT count(*) FROM pragma_table_info('step') WHERE name = 'scores'") == 1;
}

std::string DecodeHead(const Statement& row, RecordedStep& step) {
  const std::int64_t number = row.integer(StepColumns::kStep), scene = row.integer(StepColumns::kScene);
  step.time = row.integer(StepColumns::kTime);
  if (number < 0 || step.time < 0 || scene < 0) return "a number, time or scene below 0";
  step.step = static_cast<std::uint64_t>(number);
  step.hash = static_cast<std::uint64_t>(row.integer(StepColumns::kHash));
  step.scene = static_cast<std::uint64_t>(scene);
  return {};
}

std::string DecodeInputs(const Statement& row, const Scene* scene, RecordedStep& step) {
  const auto knows_channel = [scene](const CommandRecord& command) {
    return scene == nullptr || command.channel < scene->channels.size();
  };
  const auto knows_robot = [scene](const SentMessage& sent) {
    return scene == nullptr || sent.robot < scene->robots.size();
  };
  if (!DecodeCommands(row.blob(StepColumns::kCommands), step.commands) ||
      !std::ranges::all_of(step.commands, knows_channel)) {
    return "the commands";
  }
  if (!DecodeMessages(row.blob(StepColumns::kMessages), step.step, step.messages) ||
      !std::ranges::all_of(step.messages, knows_robot)) {
    return "the broadcasts";
  }
  return {};
}

std::string DecodeReadings(const Statement& row, const Scene& scene, RecordedStep& step) {
  std::size_t ranges = 0;
  for (const SceneRobot& robot : scene.robots) ranges += robot.entry.model->sector_count();
  const std::size_t sightings = 2 * scene.robots.size() * scene.targets.size();
  if (!row.is_null(StepColumns::kChannels)) {
    step.channels.resize(scene.channels.size());
    if (!DecodeChannels(row.blob(StepColumns::kChannels), scene, step.channels, step.sensed))
      return "the channels";
  }
  if (!DecodeFloats(row.blob(StepColumns::kDistances), step.distances) ||
      (!step.distances.empty() && step.distances.size() != ranges)) {
    return "the distances";
  }
  if (!DecodeFloats(row.blob(StepColumns::kTargets), step.targets) ||
      (!step.targets.empty() && step.targets.size() != sightings)) {
    return "the sighted targets";
  }
  if (!DecodeScores(row.blob(StepColumns::kScores), step.scores) ||
      (!step.scores.empty() && step.scores.size() != scene.scenario->scores.size())) {
    return "the scores";
  }
  if (row.is_null(StepColumns::kPoses)) return {};
  step.bodies.resize(scene.body_ids.size());
  return DecodePoses(row.blob(StepColumns::kPoses), step.bodies) ? "" : "the poses";
}

}  // namespace coopdyn
