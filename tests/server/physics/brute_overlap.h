// SPDX-License-Identifier: MIT
// The overlap of two convex solids by brute force: along every direction that could separate them, and many
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
  /// The extent along `direction` (of length 1), m.
  double Reach(const Vector3& direction) const;
  void MoveBy(const Vector3& way_m) { X_WS_.p += way_m; }
  const Vector3& position() const { return X_WS_.p; }
  /// Normals of flat faces, and directions of edges and axes; without their opposites.
  std::vector<Vector3> faces() const;
  std::vector<Vector3> edges() const;

 private:
  BruteSolid() = default;

  Shape shape_ = Sphere{0};
  Pose X_WS_;
  Matrix3 R_WS_ = Matrix3::Identity();
  std::vector<Vector3> faces_, edges_;  // in the solid's frame
  bool is_floor_ = false;
};

/// The least displacement that separates A from B, m; if negative, their distance. Its direction is from B to
/// A.
struct BruteOverlap {
  double depth_m = 0;
  Vector3 n_W = Vector3::UnitZ();
};
BruteOverlap FindOverlap(const BruteSolid& a, const BruteSolid& b);
/// The displacement along `n_W` that separates A from B, m.
double OverlapAlong(const BruteSolid& a, const BruteSolid& b, const Vector3& n_W);
/// The distance of `point` outside, m; negative inside.
double Outside(const BruteSolid& solid, const Vector3& point);

}  // namespace coopdyn
