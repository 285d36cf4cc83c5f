// SPDX-License-Identifier: MIT
// What the rays of a sensor meet in one frame: the floor, objects, other robots, and of its own robot the
// links that move against the one that carries it. Any thread.
#pragma once

#include "server/model/sensor_models.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

class RayCaster {
 public:
  /// Of a sensor on link `link` of `robot`. `cache` must outlive the caster.
  RayCaster(const SensingCache& cache, int robot, int link)
      : cache_(cache), robot_(robot), link_(link), X_WR_(cache.field().pose(robot)) {}

  /// The distance of the nearest thing at `max_range_m` (finite) or nearer, 0 if the ray starts inside it;
  /// kNoHit if there is none.
  double Cast(const Ray& ray_W, double max_range_m) const;
  /// The ray up to there, for drawing.
  RaySegment Segment(const Ray& ray_W, double max_range_m) const {
    const double range_m = Cast(ray_W, max_range_m);
    const bool hit = range_m < kNoHit;
    return {ray_W.origin, ray_W.origin + (hit ? range_m : max_range_m) * ray_W.direction, hit};
  }

 private:
  const SensingCache& cache_;
  const int robot_, link_;
  const Pose X_WR_;
};

}  // namespace coopdyn
