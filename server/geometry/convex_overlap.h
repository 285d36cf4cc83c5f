// SPDX-License-Identifier: MIT
// Whether two convex solids overlap, by the method of Gilbert, Johnson and Keerthi: it walks over differences
// of points of the two towards the origin. Pure; any thread.
#pragma once

#include <array>
#include <cstddef>

#include "server/geometry/shape.h"

namespace coopdyn {

/// The points of a solid that lie furthest in `direction` (any length but 0): one of them, in the shape's
/// frame.
Vector3 FurthestPoint(const Box& box, const Vector3& direction);
Vector3 FurthestPoint(const Cylinder& cylinder, const Vector3& direction);
Vector3 FurthestPoint(const Sphere& sphere, const Vector3& direction);
Vector3 FurthestPoint(const Capsule& capsule, const Vector3& direction);

/// Up to four points, and what lies between them.
class Simplex {
 public:
  void Add(const Vector3& p) { points_[count_++] = p; }
  /// The point between them that is nearest to the origin; keeps only those that it lies between. Four are
  /// left if it is the origin itself.
  Vector3 Reduce();
  std::size_t count() const { return count_; }

 private:
  Vector3 OfTwo();
  Vector3 OfThree();
  Vector3 OfFour();

  std::array<Vector3, 4> points_;
  std::size_t count_ = 0;
};

/// Whether the two have a point in common, or come nearer than 0.1 µm. `between`: about the middle of the
/// first less that of the second, any vector but 0 will do.
template <typename One, typename Other>
bool Overlap(const One& one, const Other& other, const Vector3& between) {
  constexpr int kMostSteps = 100;
  constexpr double kTouch_m = 1e-7;
  Simplex simplex;
  Vector3 nearest = between.squaredNorm() > 0 ? between : Vector3::UnitX();
  for (int step = 0; step < kMostSteps; ++step) {
    const Vector3 p = one.Support(-nearest) - other.Support(nearest);
    if (p.dot(nearest) > 0) return false;  // a plane parts them
    simplex.Add(p);
    nearest = simplex.Reduce();
    if (simplex.count() == 4 || nearest.squaredNorm() < kTouch_m * kTouch_m) return true;
  }
  return true;  // as good as touching
}

}  // namespace coopdyn
