// SPDX-License-Identifier: MIT
// What sensing derives from one frame: the field of robots at the first use of anything, the grid of movable
// objects and each robot's ranges at their first use. Lives in Frame::cache. Any thread; whoever needs a part
// first makes it, others wait for that part only.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "server/geometry/ray_grid.h"
#include "server/sensing/robot_field.h"
#include "server/sensing/scene_sensing.h"
#include "server/state/frame.h"

namespace coopdyn {

RayItem MakeRayItem(const Shape& shape, const Pose& X_WG);

/// The memory behind a cache, used again by later frames of the scene.
struct FrameBuffers {
  explicit FrameBuffers(const SceneSensing& scene);

  RobotField field;
  std::vector<RayItem> movable_items;
  RayGrid movable_grid;
  std::unique_ptr<std::atomic<std::uint8_t>[]> progress;  // of each robot's ranges
  std::vector<double> ranges_m;                           // a robot's part is guarded by its progress
};

class SensingCache final : public FrameCache {
 public:
  /// The cache of `frame`, made now if this is the first call; with `pool`'s help unless that is null.
  static const SensingCache& Of(const Frame& frame, WorkerPool* pool = nullptr);

  SensingCache(const Frame& frame, WorkerPool* pool);
  ~SensingCache() override;
  SensingCache(const SensingCache&) = delete;
  SensingCache& operator=(const SensingCache&) = delete;

  const Frame& frame() const { return frame_; }
  const SceneSensing& scene() const { return scene_; }
  const RobotField& field() const { return buffers_->field; }
  const RayGrid& movable_grid() const;

  /// Ranges with noise, right to left.
  std::span<const double> Distances(int robot) const;

  /// The nearest thing at `max_range_m` (finite) or nearer on `ray_W`, the floor and `ignored_robot` left
  /// out.
  ThingHit Cast(const Ray& ray_W, double max_range_m, int ignored_robot) const;

 private:
  void MakeRanges(int robot) const;

  const Frame& frame_;
  const SceneSensing& scene_;
  std::unique_ptr<FrameBuffers> buffers_;
  mutable std::once_flag movable_once_;
};

}  // namespace coopdyn
