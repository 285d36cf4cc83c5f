// SPDX-License-Identifier: MIT
// The nearest point of a shape within a cone, for sonars. Pure; any thread.
#pragma once

#include "server/geometry/ray.h"
#include "server/geometry/shape.h"

namespace coopdyn {

/// All points whose direction from `apex` is within `half_angle_rad` (< π/2) of the unit vector `axis`.
struct Cone {
  Vector3 apex = Vector3::Zero();
  Vector3 axis = Vector3::UnitX();
  double half_angle_rad = 0;
};

/// True if the sphere overlaps the cone.
bool ConeMeetsSphere(const Cone& cone, const Vector3& middle, double radius_m);

/// The distance from the apex of `cone` (given in the shape's frame) to the nearest point of `shape` within
/// the cone, or kNoHit if that exceeds `limit_m` (finite). Error below 0.01 mm. Shapes other than meshes are
/// solid: 0 if the apex is inside.
double NearestInCone(const Cone& cone, const Shape& shape, double limit_m);

}  // namespace coopdyn
