// SPDX-License-Identifier: MIT
#include "server/replay/verify_row.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "server/record/pose_codec.h"
#include "server/replay/verify_difference.h"

namespace coopdyn {

namespace {

bool SamePose(const BodyState& a, const BodyState& b) {
  return a.p_WB == b.p_WB && a.q_WB == b.q_WB && a.frozen() == b.frozen();
}

bool SameWheels(const RobotState& a, const RobotState& b) {
  return a.wheel_angle_rad == b.wheel_angle_rad && a.wheel_speed_rad_s == b.wheel_speed_rad_s;
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
  if (auto found = FindWheels(step, repeated)) return found;
  if (!step.distances.empty()) {
    blob_.clear();
    EncodeDistances(repeated, blob_);
    if (auto found = FindFloats(step.distances, repeated, "distances")) return found;
  }
  if (!step.targets.empty()) {
    blob_.clear();
    EncodeTargets(repeated, blob_);
    if (auto found = FindFloats(step.targets, repeated, "targets")) return found;
  }
  return std::nullopt;
}

std::optional<Difference> RowCheck::FindWheels(const RecordedStep& step, const Frame& repeated) {
  if (step.robots.size() != repeated.robots.size()) return std::nullopt;
  blob_.clear();
  EncodeWheels(repeated.robots, blob_);
  robots_.resize(repeated.robots.size());
  DecodeWheels(blob_, robots_);
  const auto [ours, theirs] = std::mismatch(robots_.begin(), robots_.end(), step.robots.begin(), SameWheels);
  if (ours == robots_.end()) return std::nullopt;
  const auto robot = static_cast<std::size_t>(ours - robots_.begin());
  Difference difference = DifferenceAt(repeated, repeated.scene->robots[robot].entry.name, "wheels");
  const auto worded = [](const RobotState& state) {
    return fmt::format("{:.5f} {:.5f} rad, {} {} rad/s", state.wheel_angle_rad[0], state.wheel_angle_rad[1],
                       state.wheel_speed_rad_s[0], state.wheel_speed_rad_s[1]);
  };
  difference.recorded = worded(*theirs);
  difference.repeated = worded(*ours);
  return difference;
}

std::optional<Difference> RowCheck::FindFloats(const std::vector<float>& recorded, const Frame& repeated,
                                               const char* reading) {
  floats_.clear();
  DecodeFloats(blob_, floats_);
  const auto same = [](float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
  };
  const auto [ours, theirs] =
      std::mismatch(floats_.begin(), floats_.end(), recorded.begin(), recorded.end(), same);
  if (ours == floats_.end() && theirs == recorded.end()) return std::nullopt;
  Difference difference =
      DifferenceAt(repeated, reading, fmt::format("number {}", ours - floats_.begin() + 1));
  difference.recorded = theirs == recorded.end() ? "missing" : fmt::format("{}", *theirs);
  difference.repeated = ours == floats_.end() ? "none" : fmt::format("{}", *ours);
  return difference;
}

}  // namespace coopdyn
