// SPDX-License-Identifier: MIT
#include "server/record/step_row.h"

#include <algorithm>
#include <array>

#include "server/record/pose_codec.h"

namespace coopdyn {

namespace {

// SQLite's record header, step number, time, hash, scene, chain.
constexpr std::size_t kFixedBytes = 41;
constexpr std::size_t kReserve = 64;  // of a page, for its header and cell pointers
// A page size that wastes this much more than the best is still taken, if it is smaller.
constexpr double kAlmostBest = 1.03;

}  // namespace

std::size_t StepRowBytes(const Frame& frame, const RecordWhat& what, bool shown) {
  std::size_t bytes = kFixedBytes;
  if (!shown) return bytes;
  bytes += 1 + frame.bodies.size() * kPoseBytes;
  const std::size_t robots = frame.scene->robots.size();
  if (what.wheels) bytes += robots * kWheelsBytes;
  if (what.targets) bytes += robots * frame.scene->targets.size() * 2 * sizeof(float);
  if (what.distances) {
    for (const SceneRobot& robot : frame.scene->robots) {
      bytes += robot.entry.model->sector_count() * sizeof(float);
    }
  }
  return bytes;
}

double FileBytesPerRow(std::size_t row_bytes, std::size_t page_size) {
  // As in SQLite's file format: a row that does not fit into a page leaves a part there, and fills pages of
  // its own with the rest.
  std::size_t local = row_bytes, overflow = 0;
  if (row_bytes > page_size - 35) {
    const std::size_t least = (page_size - 12) * 32 / 255 - 23;
    const std::size_t part = least + (row_bytes - least) % (page_size - 4);
    local = part <= page_size - 35 ? part : least;
    overflow = (row_bytes - local + page_size - 5) / (page_size - 4);
  }
  const std::size_t rows = std::max<std::size_t>(1, (page_size - kReserve) / (local + 2));
  return static_cast<double>(overflow * page_size) +
         static_cast<double>(page_size) / static_cast<double>(rows);
}

std::size_t BestPageSize(std::size_t row_bytes) {
  constexpr std::array<std::size_t, 5> kSizes{4096, 8192, 16384, 32768, 65536};
  double best = FileBytesPerRow(row_bytes, kSizes.front());
  for (const std::size_t size : kSizes) best = std::min(best, FileBytesPerRow(row_bytes, size));
  for (const std::size_t size : kSizes) {
    if (FileBytesPerRow(row_bytes, size) <= kAlmostBest * best) return size;
  }
  return kSizes.back();
}

}  // namespace coopdyn
