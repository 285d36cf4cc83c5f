// SPDX-License-Identifier: MIT
// Data that sensing derives from a scene, once for all its frames: ray fans and hulls of its robot types, the
// grid of static objects, and buffers that frames pass on to later ones. Lives in Scene::cache. Any thread.
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

/// A sensor whose values the frame keeps, because computing them costs more than a look-up.
struct KeptSensor {
  const SensorKind* kind = nullptr;  // its model
  std::uint32_t number = 0;          // of its kind, from 0
  /// Distance sensor: offset of its values among those of its robot. Other kinds have their own lists, of
  /// length `count` once read.
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::vector<SensorFan> fans;

  bool has_list() const { return !std::holds_alternative<DistanceModel>(*kind); }
};

class SceneSensing final : public SceneCache {
 public:
  /// The object of `scene`, created on the first call.
  static const SceneSensing& Of(const Scene& scene);

  explicit SceneSensing(const Scene& scene);
  ~SceneSensing() override;
  SceneSensing(const SceneSensing&) = delete;
  SceneSensing& operator=(const SceneSensing&) = delete;

  struct RobotType {
    explicit RobotType(const RobotModel& model);

    RobotHull hull;
    std::vector<KeptSensor> kept;      // distance sensors first
    std::size_t distance_sensors = 0;  // the number of these
    std::uint32_t ranges = 0;          // the number of their values

    /// The index into `kept` of sensor `number` of a kind; kept.size() if there is none.
    template <typename Kind>
    std::size_t IndexOf(std::size_t number) const {
      for (std::size_t i = 0; i < kept.size(); ++i) {
        if (std::holds_alternative<Kind>(*kept[i].kind) && kept[i].number == number) return i;
      }
      return kept.size();
    }
  };
  const RobotType& type(int robot) const { return types_[types_of_robots_[static_cast<std::size_t>(robot)]]; }

  /// A robot's first kept sensor and first distance value, among those of all robots.
  struct Place {
    std::uint32_t first_kept = 0, first_range = 0;
  };
  const Place& place(int robot) const { return places_[static_cast<std::size_t>(robot)]; }
  std::size_t robots() const { return places_.size(); }
  std::size_t kept_sensors() const { return kept_sensors_; }
  std::size_t ranges() const { return ranges_; }
  /// The largest radius of an intact hull.
  double max_hull_radius_m() const { return max_hull_radius_m_; }
  const RayGrid& static_grid() const { return static_grid_; }
  /// Indices into Scene::objects of the dynamic ones.
  const std::vector<int>& movable() const { return movable_; }

  /// Reuses buffers of an older frame, or makes new ones.
  std::unique_ptr<FrameBuffers> TakeBuffers() const EXCLUDES(mutex_);
  void GiveBuffers(std::unique_ptr<FrameBuffers> buffers) const EXCLUDES(mutex_);

 private:
  std::vector<RobotType> types_;
  std::vector<std::uint32_t> types_of_robots_;  // separate from places_: rays read it for every nearby robot
  std::vector<Place> places_;                   // by robot
  std::uint32_t kept_sensors_ = 0, ranges_ = 0;
  double max_hull_radius_m_ = 0;
  RayGrid static_grid_;
  std::vector<int> movable_;

  mutable Mutex mutex_;
  mutable std::vector<std::unique_ptr<FrameBuffers>> free_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
