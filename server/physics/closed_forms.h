// SPDX-License-Identifier: MIT
// Collision shapes with their poses, and formulas for contacts that dCollide finds less well: one contact
// where ODE returns several or one that wanders. Pure functions; any thread.
#pragma once

#include <limits>
#include <optional>

#include "server/geometry/shape.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Where A and B touch, or are about to.
struct ContactPoint {
  Vector3 p_W;
  Vector3 n_W;         // from B to A
  double depth_m = 0;  // negative: the gap still between them
};

/// The result of a closed form: it does not apply (use dCollide), or applies and finds at most one contact.
struct ClosedForm {
  bool applies = false;
  std::optional<ContactPoint> contact;
};

/// The pose of a shape in the world: centre and rotation (row-major, rows of 4 as in ODE). Not owned.
struct PlacedRotation {
  const double* p;
  const double* R;

  Vector3 position() const { return {p[0], p[1], p[2]}; }
  Vector3 point(const Vector3& local) const {
    return position() + local.x() * axis(0) + local.y() * axis(1) + local.z() * axis(2);
  }
  Vector3 axis(int i) const { return {R[i], R[4 + i], R[8 + i]}; }
  bool upright() const;  // z axis within about 2° of the vertical
};

// A part nearer to the floor than this, when the robot stands on it, carries the robot.
inline constexpr double kSupportGap_m = 2e-4;

/// One collision shape of a mechanism.
struct Part {
  Shape shape;
  int body = 0;         // of the mechanism
  double friction = 1;  // Coulomb
  double restitution = 0;
  Vector3 friction_along_G = Vector3::Zero();  // as in LinkShape, like the members below
  int friction_body = -1;                      // if not negative: friction_along_G is in this body's axes
  double friction_across = 1;
  double rolling_friction_m = 0, spinning_friction_m = 0;
  double contact_stiffness_n_m = std::numeric_limits<double>::infinity(), contact_damping_n_s_m = 0;
  /// Of the drive; -1: none. A cylinder about a driven axle, which rolls on one contact at its tread.
  int wheel = -1;
  int link = 0, collision = 0;     // of a robot's model: index into links, and into the link's collisions
  Vector3 p_BG = Vector3::Zero();  // in its body
  Matrix3 R_BG = Matrix3::Identity();
};

/// A part with its pose in the world; the rotation has rows of 4, as in ODE.
struct PlacedPart {
  PlacedPart(const Part& part, const BodyState& body);
  PlacedRotation place() const { return {p, R}; }

  const Part* part;
  double p[3];
  double R[12];
  /// Half the size of the part's bounding box along the world's axes.
  Vector3 half_m;
};

// Contacts across a gap of up to `margin_m` are also found.

// Margin of convex things, so that they keep all their points at rest.
inline constexpr double kAhead_m = 2e-4;

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
/// Two spheres. Does not apply if their centres coincide.
ClosedForm SphereAndSphere(const Sphere& a, const Vector3& p_WA, const Sphere& b, const Vector3& p_WB,
                           double margin_m);
/// Sphere A and box B. Does not apply if the sphere's centre is in the box.
ClosedForm SphereAndBox(const Sphere& a, const Vector3& p_WA, const Box& b, const PlacedRotation& X_WB,
                        double margin_m);
/// How deep `point` (world) lies inside a shape, m; ≤ 0: outside.
double DepthInside(const Shape& shape, const PlacedRotation& X_WS, const Vector3& point);

}  // namespace coopdyn
