// SPDX-License-Identifier: MIT
// What sensing derives from one frame, each part at its first use: robots' poses, the grid of all shapes, and
// the ranges of each robot. Lives in Frame::cache. Any thread; whoever needs a part first makes it, others
// wait for that part only.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "server/geometry/ray_grid.h"
#include "server/state/frame.h"

namespace coopdyn {

class SensingCache final : public FrameCache {
 public:
  /// The cache of `frame`, made now if this is the first call.
  static const SensingCache& Of(const Frame& frame);

  explicit SensingCache(const Frame& frame);

  /// X_WR of robot `robot`.
  const Pose& robot_pose(int robot) const { return robot_poses_[static_cast<std::size_t>(robot)]; }
  /// All shapes that rays can hit except the floor. A robot's shapes belong to owner `OwnerOf(robot)`.
  const RayGrid& grid() const;
  /// Ranges with noise, right to left.
  std::span<const double> Distances(int robot) const;

  static std::uint32_t OwnerOf(int robot) { return static_cast<std::uint32_t>(robot) + 1; }
  static constexpr std::uint32_t kNobody = 0;  // owner of the world's objects

 private:
  struct RobotRanges {
    std::once_flag once;
    std::uint32_t first = 0;  // in ranges_m_
    std::uint32_t count = 0;
  };

  const Frame& frame_;
  std::vector<Pose> robot_poses_;
  mutable std::once_flag grid_once_;
  mutable std::optional<RayGrid> grid_;  // guarded by grid_once_
  std::unique_ptr<RobotRanges[]> robot_ranges_;
  mutable std::vector<double> ranges_m_;  // a robot's part is guarded by its `once`
};

}  // namespace coopdyn
