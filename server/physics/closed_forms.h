// SPDX-License-Identifier: MIT
// Contacts that are better found by a formula than by dCollide: one contact where ODE makes several or
// wanders. Pure functions; any thread.
#pragma once

#include <optional>

#include "server/geometry/shape.h"

namespace coopdyn {

/// Where A and B touch, or are about to.
struct ContactPoint {
  Vector3 p_W;
  Vector3 n_W;         // from B to A
  double depth_m = 0;  // negative: the gap still between them
};

/// What a closed form found: it may not apply (ask dCollide), or apply and find at most one contact.
struct ClosedForm {
  bool applies = false;
  std::optional<ContactPoint> contact;
};

/// A shape of ODE in the world: centre and rotation (row-major, rows of 4 as ODE keeps them).
struct PlacedRotation {
  const double* p;
  const double* R;

  Vector3 position() const { return {p[0], p[1], p[2]}; }
  Vector3 axis(int i) const { return {R[i], R[4 + i], R[8 + i]}; }
  bool upright() const;  // z axis within about 2° of the vertical
};

// Contacts across a gap of up to `margin_m` count too.

/// Wheel A, as a disc in the middle of its tread, on the floor z = 0. Does not apply to a wheel that lies on
/// its side.
ClosedForm WheelOnFloor(double radius_m, const PlacedRotation& wheel, double margin_m = 0);
/// Wheel A on top of a box B (a face that rises less than 60°). Does not apply near edges, where the wheel
/// must climb.
ClosedForm WheelOnBox(double radius_m, const PlacedRotation& wheel, const Box& box,
                      const PlacedRotation& X_WB, double margin_m = 0);
/// Two upright cylinders side by side. Does not apply to one that stands on the other.
ClosedForm UprightCylinders(const Cylinder& a, const PlacedRotation& X_WA, const Cylinder& b,
                            const PlacedRotation& X_WB, double margin_m = 0);
/// Upright cylinder A beside upright box B. Does not apply to one that stands on the other.
ClosedForm UprightCylinderAndBox(const Cylinder& a, const PlacedRotation& X_WA, const Box& b,
                                 const PlacedRotation& X_WB, double margin_m = 0);
/// How deep `point` (world) lies inside a shape, m; ≤ 0: outside.
double DepthInside(const Shape& shape, const PlacedRotation& X_WS, const Vector3& point);

}  // namespace coopdyn
