// SPDX-License-Identifier: MIT
// What sensing derives from a scene, once for all its frames: the fans of rays and the hulls of its robot
// types, the grid of what never moves, and buffers that frames hand on to later ones. Lives in Scene::cache.
// Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/base/mutex.h"
#include "server/geometry/ray_grid.h"
#include "server/sensing/robot_hull.h"
#include "server/sensing/sensor_fan.h"
#include "server/state/scene.h"

namespace coopdyn {

struct FrameBuffers;

class SceneSensing final : public SceneCache {
 public:
  /// That of `scene`, made now if this is the first call.
  static const SceneSensing& Of(const Scene& scene);

  explicit SceneSensing(const Scene& scene);
  ~SceneSensing() override;
  SceneSensing(const SceneSensing&) = delete;
  SceneSensing& operator=(const SceneSensing&) = delete;

  struct RobotType {
    explicit RobotType(const RobotModel& model) : hull(model) {}

    RobotHull hull;
    std::vector<SensorFan> fans;
  };
  const RobotType& type(int robot) const { return types_[types_of_robots_[static_cast<std::size_t>(robot)]]; }

  /// Index of the first distance of `robot` among those of all robots; robot = their number: the sum.
  std::uint32_t first_range(int robot) const { return first_ranges_[static_cast<std::size_t>(robot)]; }
  std::size_t robots() const { return types_of_robots_.size(); }
  /// The largest radius of a hull that is whole.
  double max_hull_radius_m() const { return max_hull_radius_m_; }
  const RayGrid& static_grid() const { return static_grid_; }
  /// Indices into Scene::objects of those that move.
  const std::vector<int>& movable() const { return movable_; }

  /// Buffers of an older frame, or new ones.
  std::unique_ptr<FrameBuffers> TakeBuffers() const EXCLUDES(mutex_);
  void GiveBuffers(std::unique_ptr<FrameBuffers> buffers) const EXCLUDES(mutex_);

 private:
  std::vector<RobotType> types_;
  std::vector<std::uint32_t> types_of_robots_, first_ranges_;
  double max_hull_radius_m_ = 0;
  RayGrid static_grid_;
  std::vector<int> movable_;

  mutable Mutex mutex_;
  mutable std::vector<std::unique_ptr<FrameBuffers>> free_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
