// SPDX-License-Identifier: MIT
// The nearest point of a shape within a cone: what a sonar hears. Pure; any thread.
#pragma once

#include "server/geometry/ray.h"
#include "server/geometry/shape.h"

namespace coopdyn {

/// All points whose direction from `apex` is within `half_angle_rad` of `axis`. The axis has length 1, the
/// angle is less than a right one.
struct Cone {
  Vector3 apex = Vector3::Zero();
  Vector3 axis = Vector3::UnitX();
  double half_angle_rad = 0;
};

/// Whether anything of a sphere is within the cone.
bool ConeMeetsSphere(const Cone& cone, const Vector3& middle, double radius_m);

/// The distance from the apex of `cone` (given in the shape's frame) to the nearest point of `shape` within
/// the cone if that is `limit_m` (finite) or less, else kNoHit. Off by less than 0.01 mm. Shapes but meshes
/// are solid: 0 if the apex is inside.
double NearestInCone(const Cone& cone, const Shape& shape, double limit_m);

}  // namespace coopdyn
