// SPDX-License-Identifier: MIT
// What sensing derives from a scene, once for all its frames: the fans of rays and the hulls of its robot
// types, the grid of what never moves, and buffers that frames hand on to later ones. Lives in Scene::cache.
// Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "server/base/mutex.h"
#include "server/geometry/ray_grid.h"
#include "server/sensing/robot_hull.h"
#include "server/sensing/sensor_fan.h"
#include "server/state/scene.h"

namespace coopdyn {

struct FrameBuffers;

/// A sensor whose values a frame keeps, since computing them costs more than looking them up.
struct KeptSensor {
  const SensorKind* kind = nullptr;  // its model
  std::uint32_t number = 0;          // of its kind, from 0
  /// Of a distance sensor: of its values among those of its robot. Others have lists of their own, which are
  /// as long as `count` once somebody has read them.
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::vector<SensorFan> fans;

  bool has_list() const { return !std::holds_alternative<DistanceModel>(*kind); }
};

class SceneSensing final : public SceneCache {
 public:
  /// That of `scene`, made now if this is the first call.
  static const SceneSensing& Of(const Scene& scene);

  explicit SceneSensing(const Scene& scene);
  ~SceneSensing() override;
  SceneSensing(const SceneSensing&) = delete;
  SceneSensing& operator=(const SceneSensing&) = delete;

  struct RobotType {
    explicit RobotType(const RobotModel& model);

    RobotHull hull;
    std::vector<KeptSensor> kept;      // the distance sensors first
    std::size_t distance_sensors = 0;  // of them
    std::uint32_t ranges = 0;          // of these

    /// The index into `kept` of sensor `number` of a kind; kept.size() if there are fewer.
    template <typename Kind>
    std::size_t IndexOf(std::size_t number) const {
      for (std::size_t i = 0; i < kept.size(); ++i) {
        if (std::holds_alternative<Kind>(*kept[i].kind) && kept[i].number == number) return i;
      }
      return kept.size();
    }
  };
  const RobotType& type(int robot) const { return types_[types_of_robots_[static_cast<std::size_t>(robot)]]; }

  /// Where the kept sensors of a robot and its distances begin among those of all robots.
  struct Place {
    std::uint32_t first_kept = 0, first_range = 0;
  };
  const Place& place(int robot) const { return places_[static_cast<std::size_t>(robot)]; }
  std::size_t robots() const { return places_.size(); }
  std::size_t kept_sensors() const { return kept_sensors_; }
  std::size_t ranges() const { return ranges_; }
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
  std::vector<std::uint32_t> types_of_robots_;  // apart from places_: rays look at it of all who are near
  std::vector<Place> places_;                   // by robot
  std::uint32_t kept_sensors_ = 0, ranges_ = 0;
  double max_hull_radius_m_ = 0;
  RayGrid static_grid_;
  std::vector<int> movable_;

  mutable Mutex mutex_;
  mutable std::vector<std::unique_ptr<FrameBuffers>> free_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
