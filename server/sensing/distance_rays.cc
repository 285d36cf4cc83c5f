// SPDX-License-Identifier: MIT
#include "server/sensing/distance_rays.h"

#include <cmath>

namespace coopdyn {

Ray SensorRay(const DistanceSensorModel& sensor, const Pose& X_WS, int index) {
  const double angle_rad =
      sensor.rays > 1 ? sensor.opening_rad * (static_cast<double>(index) / (sensor.rays - 1) - 0.5) : 0;
  return {X_WS.p, X_WS.q * Vector3(std::cos(angle_rad), std::sin(angle_rad), 0)};
}

double CastSensorRay(const RayGrid& grid, const Ray& ray_W, double max_range_m, int robot) {
  const double floor_m = RayToFloor(ray_W);
  const double range_m = floor_m < max_range_m ? floor_m : max_range_m;
  const RayHit hit = grid.Cast(ray_W, range_m, SensingCache::OwnerOf(robot));
  if (hit) return hit.distance_m;
  return floor_m <= max_range_m ? floor_m : kNoHit;
}

}  // namespace coopdyn
