// SPDX-License-Identifier: MIT
// Overlap test of two convex solids by the method of Gilbert, Johnson and Keerthi, which searches the
// differences of their points for the origin. Pure; any thread.
#pragma once

#include <array>
#include <cstddef>

#include "server/geometry/shape.h"

namespace coopdyn {

/// A point of a solid that lies furthest in `direction` (of any length but 0), in the shape's frame.
Vector3 FurthestPoint(const Box& box, const Vector3& direction);
Vector3 FurthestPoint(const Cylinder& cylinder, const Vector3& direction);
Vector3 FurthestPoint(const Sphere& sphere, const Vector3& direction);
Vector3 FurthestPoint(const Capsule& capsule, const Vector3& direction);

/// The convex hull of up to four points.
class Simplex {
 public:
  void Add(const Vector3& p) { points_[count_++] = p; }
  /// Returns the point of the hull nearest to the origin, and keeps only the points that span it. Keeps four
  /// if the nearest point is the origin itself.
  Vector3 Reduce();
  std::size_t count() const { return count_; }

 private:
  Vector3 OfTwo();
  Vector3 OfThree();
  Vector3 OfFour();

  std::array<Vector3, 4> points_;
  std::size_t count_ = 0;
};

/// True if the two solids share a point or are closer than 0.1 µm. `between`: roughly the first solid's
/// centre minus the second's; any non-zero vector works.
template <typename One, typename Other>
bool Overlap(const One& one, const Other& other, const Vector3& between) {
  constexpr int kMostSteps = 100;
  constexpr double kTouch_m = 1e-7;
  Simplex simplex;
  Vector3 nearest = between.squaredNorm() > 0 ? between : Vector3::UnitX();
  for (int step = 0; step < kMostSteps; ++step) {
    const Vector3 p = one.Support(-nearest) - other.Support(nearest);
    if (p.dot(nearest) > 0) return false;  // a plane separates them
    simplex.Add(p);
    nearest = simplex.Reduce();
    if (simplex.count() == 4 || nearest.squaredNorm() < kTouch_m * kTouch_m) return true;
  }
  return true;  // as good as touching
}

}  // namespace coopdyn
