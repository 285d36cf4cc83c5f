// SPDX-License-Identifier: MIT
// Closed-form ray casts against solid shapes. Pure; any thread.
#pragma once

#include <limits>

#include "server/geometry/shape.h"

namespace coopdyn {

/// A half-line. `origin` and `direction` (a unit vector) are in the same frame.
struct Ray {
  Vector3 origin = Vector3::Zero();
  Vector3 direction = Vector3::UnitX();
};

inline constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// Distance along `ray` (given in the shape's frame) to the solid, m: 0 if the ray starts inside, kNoHit if
/// it misses.
double RayToBox(const Ray& ray, const Box& box);
double RayToCylinder(const Ray& ray, const Cylinder& cylinder);
double RayToSphere(const Ray& ray, const Sphere& sphere);
double RayToCapsule(const Ray& ray, const Capsule& capsule);
double RayToShape(const Ray& ray, const Shape& shape);

/// The same for a cylinder along the unit vector `axis`, in any frame whose origin is the cylinder's centre.
/// Equals RayToCylinder() in the cylinder's frame up to rounding.
double RayToCylinder(const Ray& ray, const Cylinder& cylinder, const Vector3& axis);

/// Distance along `ray` (in the world) to the half-space z ≤ 0, m.
double RayToFloor(const Ray& ray);

}  // namespace coopdyn
