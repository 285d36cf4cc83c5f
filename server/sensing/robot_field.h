// SPDX-License-Identifier: MIT
// All robots of one frame: their poses, and look-up of those near a point or along a ray. Read-only once
// built; any thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/base/worker_pool.h"
#include "server/geometry/point_grid.h"
#include "server/sensing/scene_sensing.h"
#include "server/state/frame.h"

namespace coopdyn {

/// The nearest hit of a ray.
struct ThingHit {
  double distance_m = kNoHit;
  int robot = -1;  // the robot hit; -1: something else

  explicit operator bool() const { return distance_m < kNoHit; }
};

class RobotField {
 public:
  /// A robot and an upright cylinder that contains it.
  struct Entry {
    double x = 0, y = 0;
    double radius_m = 0;
    double min_z = 0, max_z = 0;
    int robot = 0;

    /// False only if the ray hits nothing inside the cylinder nearer than `nearest_m`.
    bool MayMeet(const Vector3& origin_W, const Vector3& direction_W, double nearest_m) const {
      const double dx = x - origin_W.x(), dy = y - origin_W.y();
      const double along = dx * direction_W.x() + dy * direction_W.y();
      const double across = dx * direction_W.y() - dy * direction_W.x();
      const double length2 = direction_W.x() * direction_W.x() + direction_W.y() * direction_W.y();
      if (across * across > radius_m * radius_m * length2) return false;
      if (along < -radius_m || along - radius_m > nearest_m * length2) return false;
      const double start_z = origin_W.z(), end_z = start_z + nearest_m * direction_W.z();
      return std::max(start_z, end_z) >= min_z && std::min(start_z, end_z) <= max_z;
    }
  };

  /// Fills the field with the robots of `frame`, also using `pool`'s threads unless it is null.
  void Build(const Frame& frame, const SceneSensing& scene, WorkerPool* pool);

  /// X_WR of robot `robot`.
  const Pose& pose(int robot) const { return poses_[static_cast<std::size_t>(robot)]; }

  /// Calls visit(entries) for spans that together contain every robot whose centre is within `radius_m` of
  /// (x, y), and other robots nearby; each robot once.
  template <typename Visit>
  void ForCenters(double x, double y, double radius_m, Visit visit) const {
    grid_.ForRuns({x - radius_m, y - radius_m, x + radius_m, y + radius_m},
                  [&](std::uint32_t first, std::uint32_t end) { visit(Entries(first, end)); });
  }
  /// The same for robots with any part within `radius_m`; may visit a robot twice.
  template <typename Visit>
  void ForHulls(double x, double y, double radius_m, Visit visit) const {
    ForCenters(x, y, radius_m + hull_radius_m_, visit);
    if (!wide_.empty()) visit(std::span(wide_));
  }

  /// The nearest hit of `ray_W` with a robot other than `ignored_robot`, nearer than `nearest_m` (finite).
  ThingHit Cast(const Frame& frame, const SceneSensing& scene, const Ray& ray_W, double nearest_m,
                int ignored_robot) const;

 private:
  std::span<const Entry> Entries(std::uint32_t first, std::uint32_t end) const {
    return std::span(entries_).subspan(first, end - first);
  }

  std::vector<Pose> poses_;      // by robot
  std::vector<Point2> centers_;  // by robot
  std::vector<Entry> by_robot_;
  PointGrid grid_;              // of centers_
  std::vector<Entry> entries_;  // in the grid's order
  std::vector<Entry> wide_;     // robots that have come apart; hull_radius_m_ ignores them
  double hull_radius_m_ = 0;    // largest radius of all other robots
};

}  // namespace coopdyn
