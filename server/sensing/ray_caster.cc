// SPDX-License-Identifier: MIT
#include "server/sensing/ray_caster.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

double RayCaster::Cast(const Ray& ray_W, double max_range_m) const {
  const SceneSensing& scene = cache_.scene();
  double nearest_m = RayToFloor(ray_W);
  const auto limit_m = [&] { return std::min(nearest_m, max_range_m); };
  if (!scene.static_grid().empty())
    nearest_m = std::min(nearest_m, scene.static_grid().Cast(ray_W, limit_m()));
  if (!scene.movable().empty()) nearest_m = std::min(nearest_m, cache_.movable_grid().Cast(ray_W, limit_m()));
  double robots_m = std::nextafter(limit_m(), kNoHit);
  if (scene.robots() > 1) {
    const ThingHit hit = cache_.field().Cast(cache_.frame(), scene, ray_W, robots_m, robot_);
    robots_m = std::min(robots_m, hit.distance_m);
  }
  scene.type(robot_).hull.Cast(cache_.frame(), robot_, X_WR_, ray_W, robots_m, link_);
  if (robots_m <= limit_m()) nearest_m = robots_m;
  return nearest_m <= max_range_m ? nearest_m : kNoHit;
}

}  // namespace coopdyn
