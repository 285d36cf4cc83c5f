// SPDX-License-Identifier: MIT
// Finds the first thing on a ray, for pointing. Tests all things. Pure; any thread.
#pragma once

#include "server/geometry/ray.h"
#include "server/state/frame.h"

namespace coopdyn {

struct Picked {
  int object = -1, robot = -1;  // indices into the scene; both -1: the floor
  double distance_m = kNoHit;   // kNoHit: nothing
};

/// The floor ends at its edges. Robots count with their collision shapes.
Picked Pick(const Frame& frame, const Ray& ray_W);

}  // namespace coopdyn
