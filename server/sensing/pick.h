// SPDX-License-Identifier: MIT
// What a ray meets first: for pointing at things. Looks at all of them. Pure; any thread.
#pragma once

#include "server/geometry/ray.h"
#include "server/state/frame.h"

namespace coopdyn {

struct Picked {
  int object = -1, robot = -1;  // index into the scene; both -1: the floor
  double distance_m = kNoHit;   // kNoHit: nothing
};

/// The floor ends where it ends. Robots are their collision shapes.
Picked Pick(const Frame& frame, const Ray& ray_W);

}  // namespace coopdyn
