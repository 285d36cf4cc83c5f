// SPDX-License-Identifier: MIT
#include "server/replay/verify_row.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "server/record/pose_codec.h"
#include "server/record/run_tables.h"
#include "server/replay/run_columns.h"
#include "server/replay/verify_difference.h"

namespace coopdyn {

namespace {

bool SamePose(const BodyState& a, const BodyState& b) {
  return a.p_WB == b.p_WB && a.q_WB == b.q_WB && a.frozen() == b.frozen();
}

}  // namespace

std::optional<Difference> RowCheck::Find(const RecordedStep& step, const Frame& repeated) {
  if (step.bodies.size() == repeated.bodies.size()) {
    blob_.clear();
    EncodePoses(repeated.bodies, blob_);
    bodies_.resize(repeated.bodies.size());
    DecodePoses(blob_, bodies_);
    if (!std::equal(bodies_.begin(), bodies_.end(), step.bodies.begin(), SamePose)) {
      if (auto found = FindPose(step.bodies, repeated)) return found;
      Difference difference = DifferenceAt(repeated, "the recorded poses", "rounding");
      difference.recorded = "other bits";
      difference.repeated = "those of the exact state";
      return difference;
    }
  }
  if (auto found = FindMotion(step, repeated)) return found;
  if (!step.distances.empty()) {
    if (auto found = FindDistance(step.distances, repeated)) return found;
  }
  if (!step.targets.empty()) {
    if (auto found = FindTarget(step.targets, repeated)) return found;
  }
  return std::nullopt;
}

std::optional<Difference> RowCheck::FindMotion(const RecordedStep& step, const Frame& repeated) {
  if (step.channels.size() != repeated.channels.size()) return std::nullopt;
  blob_.clear();
  EncodeChannels(repeated.channels, blob_);
  channels_.resize(step.channels.size());
  DecodeChannels(blob_, channels_);
  const auto [ours, theirs] = std::mismatch(channels_.begin(), channels_.end(), step.channels.begin());
  if (ours == channels_.end()) return std::nullopt;
  const auto channel = static_cast<std::size_t>(ours - channels_.begin());
  const auto robot = static_cast<std::size_t>(repeated.scene->channels[channel].robot);
  Difference difference =
      DifferenceAt(repeated, repeated.scene->robots[robot].entry.name, ChannelName(*repeated.scene, channel));
  const auto worded = [](const ChannelMotion& motion) {
    return fmt::format("{:.5f} rad, {} rad/s", motion.position, motion.velocity);
  };
  difference.recorded = worded(*theirs);
  difference.repeated = worded(*ours);
  return difference;
}

std::optional<std::size_t> RowCheck::FindReading(const std::vector<float>& recorded) {
  floats_.clear();
  DecodeFloats(blob_, floats_);
  const auto same = [](float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
  };
  const auto [ours, theirs] =
      std::mismatch(floats_.begin(), floats_.end(), recorded.begin(), recorded.end(), same);
  if (ours == floats_.end() && theirs == recorded.end()) return std::nullopt;
  return static_cast<std::size_t>(ours - floats_.begin());
}

std::optional<Difference> RowCheck::FindDistance(const std::vector<float>& recorded, const Frame& repeated) {
  blob_.clear();
  EncodeDistances(repeated, blob_);
  const std::optional<std::size_t> place = FindReading(recorded);
  if (!place) return std::nullopt;
  const std::vector<SceneRobot>& robots = repeated.scene->robots;
  std::size_t robot = 0, sensor = *place;
  for (; robot < robots.size(); ++robot) {
    const std::size_t sensors = robots[robot].entry.model->sector_count();
    if (sensor < sensors) break;
    sensor -= sensors;
  }
  return ReadingDiffers(recorded, repeated, *place, robot, fmt::format("d{}_m", sensor + 1));
}

std::optional<Difference> RowCheck::FindTarget(const std::vector<float>& recorded, const Frame& repeated) {
  blob_.clear();
  EncodeTargets(repeated, blob_);
  const std::optional<std::size_t> place = FindReading(recorded);
  if (!place) return std::nullopt;
  const std::vector<Target>& targets = repeated.scene->targets;
  const std::size_t each = 2 * std::max<std::size_t>(targets.size(), 1);  // readings of a robot
  std::string field = *place % 2 == 0 ? "_distance_m" : "_bearing_rad";
  std::string error;
  const RunColumns columns = ChooseColumns(std::span(&repeated.scene, 1), {}, error);
  for (const TargetColumn& column : columns.targets) {
    if (column.id == targets[*place % each / 2].id) field.insert(0, column.label);
  }
  return ReadingDiffers(recorded, repeated, *place, *place / each, std::move(field));
}

Difference RowCheck::ReadingDiffers(const std::vector<float>& recorded, const Frame& repeated,
                                    std::size_t place, std::size_t robot, std::string field) const {
  const std::vector<SceneRobot>& robots = repeated.scene->robots;
  Difference difference = robot < robots.size()
                              ? DifferenceAt(repeated, robots[robot].entry.name, std::move(field))
                              : DifferenceAt(repeated, "the readings", "after those of the last robot");
  const auto worded = [place](const std::vector<float>& readings) {
    return place < readings.size() ? fmt::format("{}", readings[place]) : "none";
  };
  difference.recorded = worded(recorded);
  difference.repeated = worded(floats_);
  return difference;
}

}  // namespace coopdyn
