// SPDX-License-Identifier: MIT
// Casts a sensor's rays in one frame, against the floor, objects, other robots, and those links of its own
// robot that move relative to the sensor's link. Any thread.
#pragma once

#include "server/model/sensor_models.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

class RayCaster {
 public:
  /// For a sensor on link `link` of `robot`. `cache` must outlive the caster.
  RayCaster(const SensingCache& cache, int robot, int link)
      : cache_(cache), robot_(robot), link_(link), X_WR_(cache.field().pose(robot)) {}

  /// The distance to the nearest thing within `max_range_m` (finite), 0 if the ray starts inside it; kNoHit
  /// if nothing is hit.
  double Cast(const Ray& ray_W, double max_range_m) const;
  /// The ray up to that distance, for drawing.
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
