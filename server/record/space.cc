// SPDX-License-Identifier: MIT
#include "server/record/space.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "server/state/pose_codec.h"

namespace coopdyn {

namespace {

// SQLite's record header, step number, time, hash, scene, chain.
constexpr std::size_t kFixedBytes = 41;
constexpr double kStepsPerKeyframe = 500;  // default of RecorderOptions
constexpr double kPageShare = 1.06;        // bytes of pages per byte of rows, on average

/// Two figures and a unit: 950 B, 2.0 MB, 58 GB.
std::string BytesText(double bytes) {
  constexpr std::array<const char*, 6> kUnits{"B", "kB", "MB", "GB", "TB", "PB"};
  std::size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < kUnits.size()) {
    bytes /= 1000;
    ++unit;
  }
  std::array<char, 32> text{};
  const int digits = unit > 0 && bytes < 9.95 ? 1 : 0;
  std::snprintf(text.data(), text.size(), "%.*f %s", digits, bytes, kUnits[unit]);
  return text.data();
}

}  // namespace

std::size_t StepRowBytes(const Frame& frame, const RecordWhat& what, bool shown) {
  std::size_t bytes = kFixedBytes + frame.scores.size() * 9;
  if (!shown) return bytes;
  bytes += 1 + frame.bodies.size() * kPoseBytes;
  if (what.channels) bytes += frame.channels.size() * kChannelBytes + frame.measured.size() * sizeof(float);
  if (what.targets) bytes += frame.scene->robots.size() * frame.scene->targets.size() * 2 * sizeof(float);
  if (what.distances) {
    for (const SceneRobot& robot : frame.scene->robots) {
      bytes += robot.entry.model->sector_count() * sizeof(float);
    }
  }
  return bytes;
}

std::size_t PageSizeFor(std::size_t row_bytes) {
  // About sixteen rows per page leave little unused at its end. A row of more than an eighth of the largest
  // page overflows into its own pages: small pages waste least in the last one.
  constexpr std::size_t kLeast = 4096, kMost = 65536;
  if (row_bytes > kMost / 8) return kLeast;
  return std::clamp(std::bit_ceil(16 * row_bytes), kLeast, kMost);
}

SpaceNeeded EstimateSpace(const Frame& frame, const RecordWhat& what, Nanoseconds pose_every,
                          double duration_s, const std::string& file) {
  SpaceNeeded space;
  const double step_s = ToSeconds(frame.step_length);
  const double shown_share = pose_every > frame.step_length
                                 ? static_cast<double>(frame.step_length) / static_cast<double>(pose_every)
                                 : 1;
  const auto shown_bytes = static_cast<double>(StepRowBytes(frame, what, true));
  const auto other_bytes = static_cast<double>(StepRowBytes(frame, what, false));
  const auto keyframe_bytes = static_cast<double>(frame.bodies.size() * sizeof(BodyState) +
                                                  frame.channels.size() * sizeof(ChannelState));
  const double per_step = kPageShare * (shown_bytes * shown_share + other_bytes * (1 - shown_share)) +
                          keyframe_bytes / kStepsPerKeyframe;
  space.bytes_per_s = per_step / step_s;
  if (duration_s > 0 && std::isfinite(duration_s)) space.bytes_in_all = space.bytes_per_s * duration_s;
  std::error_code none;
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const auto disk = std::filesystem::space(folder.empty() ? "." : folder, none);
  space.bytes_free = none ? 0 : static_cast<double>(disk.available);
  return space;
}

std::string ToString(const SpaceNeeded& space) {
  std::string text = "about " + BytesText(space.bytes_per_s) + " per simulated second";
  if (space.bytes_in_all > 0) text += ", " + BytesText(space.bytes_in_all) + " for this run";
  return text + ", " + BytesText(space.bytes_free) + " free";
}

}  // namespace coopdyn
