// SPDX-License-Identifier: MIT
// How far two convex solids overlap, by brute force: along each direction that could part them, and many
// more.
#pragma once

#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn {

/// A convex solid in the world, or the half space below a plane.
class BruteSolid {
 public:
  BruteSolid(const Shape& shape, const Pose& X_WS);
  /// The half space below z = 0.
  static BruteSolid Floor();

  bool is_floor() const { return is_floor_; }
  /// How far it reaches along `direction` (of length 1), m.
  double Reach(const Vector3& direction) const;
  void MoveBy(const Vector3& way_m) { X_WS_.p += way_m; }
  const Vector3& position() const { return X_WS_.p; }
  /// Directions along which flat faces look, and along which its edges and axes run; without their opposites.
  std::vector<Vector3> faces() const;
  std::vector<Vector3> edges() const;

 private:
  BruteSolid() = default;

  Shape shape_ = Sphere{0};
  Pose X_WS_;
  Matrix3 R_WS_ = Matrix3::Identity();
  std::vector<Vector3> faces_, edges_;  // in its own frame
  bool is_floor_ = false;
};

/// The least way that parts A from B, m, negative: their distance; and its direction, from B to A.
struct BruteOverlap {
  double depth_m = 0;
  Vector3 n_W = Vector3::UnitZ();
};
BruteOverlap FindOverlap(const BruteSolid& a, const BruteSolid& b);
/// By how much the way along `n_W` parts A from B, m.
double OverlapAlong(const BruteSolid& a, const BruteSolid& b, const Vector3& n_W);
/// How far `point` is outside, m; negative within.
double Outside(const BruteSolid& solid, const Vector3& point);

}  // namespace coopdyn
