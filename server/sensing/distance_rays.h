// SPDX-License-Identifier: MIT
// How the rays of a distance sensor lie, and what one of them meets. Pure; any thread.
#pragma once

#include "server/model/robot_model.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

/// Ray `index` of `sensor` in the sensor's frame turned by `X_WS`: from its origin, spread evenly from the
/// right edge of the sector to its left one.
Ray SensorRay(const DistanceSensorModel& sensor, const Pose& X_WS, int index);
/// Distance to the nearest thing on `ray_W` that robot `robot` can feel, the floor included; kNoHit beyond
/// `max_range_m`.
double CastSensorRay(const RayGrid& grid, const Ray& ray_W, double max_range_m, int robot);

}  // namespace coopdyn
