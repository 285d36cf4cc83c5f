// SPDX-License-Identifier: MIT
// The simple shapes of the world. Each is centred at the origin of its own frame.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <variant>

#include "server/base/portable_math.h"

namespace coopdyn {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

struct Box {
  Vector3 size_m;  // full lengths along x, y, z
  bool operator==(const Box&) const = default;
};

/// Axis along z.
struct Cylinder {
  double radius_m = 0;
  double length_m = 0;
  bool operator==(const Cylinder&) const = default;
};

struct Sphere {
  double radius_m = 0;
  bool operator==(const Sphere&) const = default;
};

/// A cylinder along z with a half sphere on each end.
struct Capsule {
  double radius_m = 0;
  double length_m = 0;  // of the cylinder
  bool operator==(const Capsule&) const = default;
};

struct MeshData;
/// Triangles (server/geometry/mesh.h) about the centre of their bounding box. `data` is not owned.
struct Mesh {
  const MeshData* data = nullptr;
  bool operator==(const Mesh&) const = default;
};

using Shape = std::variant<Box, Cylinder, Sphere, Capsule, Mesh>;

/// X_AB: the pose of frame B in frame A. p_A = R_AB p_B + p_AB.
struct Pose {
  Vector3 p = Vector3::Zero();
  Quaternion q = Quaternion::Identity();

  Vector3 operator*(const Vector3& p_B) const { return q * p_B + p; }
  Pose operator*(const Pose& X_BC) const { return {q * X_BC.p + p, q * X_BC.q}; }
  Pose Inverse() const { return {q.conjugate() * -p, q.conjugate()}; }
};

/// Rotation by roll, pitch, yaw about the fixed axes x, y, z (in this order).
inline Quaternion FromRollPitchYaw(double roll_rad, double pitch_rad, double yaw_rad) {
  return portable::AngleAxis(yaw_rad, Vector3::UnitZ()) * portable::AngleAxis(pitch_rad, Vector3::UnitY()) *
         portable::AngleAxis(roll_rad, Vector3::UnitX());
}

/// The inverse: roll and yaw in [−π, π], pitch in [−π/2, π/2].
Vector3 ToRollPitchYaw(const Quaternion& q);

/// Heading of the x axis of `q` in the horizontal plane, in (−π, π].
double Heading(const Quaternion& q);
/// `angle_rad` wrapped into (−π, π].
double WrapAngle(double angle_rad);
/// Radius of the smallest sphere about the shape's centre that contains the shape.
double BoundingRadius(const Shape& shape);
/// Half the shape's extent along the world's x, y, z when rotated by `q`.
Vector3 HalfExtents(const Shape& shape, const Quaternion& q);
/// The same for a rotation matrix `R`.
Vector3 HalfExtents(const Shape& shape, const Matrix3& R);
/// Volume in m³.
double Volume(const Shape& shape);
/// Diagonal inertia of the solid shape of mass `mass_kg` about its centre, kg·m².
Vector3 SolidInertia(const Shape& shape, double mass_kg);

}  // namespace coopdyn
