// SPDX-License-Identifier: MIT
// EstimateSpace() and its words, of recorder.h.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "server/record/recorder.h"
#include "server/record/step_row.h"

namespace coopdyn {

namespace {

constexpr double kStepsPerKeyframe = 500;  // as RecorderOptions says by default

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

SpaceNeeded EstimateSpace(const Frame& frame, const RecordWhat& what, Nanoseconds pose_every,
                          double duration_s, const std::string& file) {
  SpaceNeeded space;
  const std::size_t shown_bytes = StepRowBytes(frame, what, true);
  const std::size_t page_size = BestPageSize(shown_bytes);
  const double step_s = ToSeconds(frame.step_length);
  const double shown_share = pose_every > frame.step_length
                                 ? static_cast<double>(frame.step_length) / static_cast<double>(pose_every)
                                 : 1;
  const auto keyframe_bytes = static_cast<double>(frame.bodies.size() * sizeof(BodyState) +
                                                  frame.channels.size() * sizeof(ChannelState));
  const double per_step = FileBytesPerRow(shown_bytes, page_size) * shown_share +
                          FileBytesPerRow(StepRowBytes(frame, what, false), page_size) * (1 - shown_share) +
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
