// SPDX-License-Identifier: MIT
#include "server/geometry/convex_overlap.h"

#include <cmath>

#include "server/base/portable_math.h"
#include "server/geometry/ray.h"

namespace coopdyn {

Vector3 FurthestPoint(const Box& box, const Vector3& direction) {
  const Vector3 half = box.size_m / 2;
  return {std::copysign(half.x(), direction.x()), std::copysign(half.y(), direction.y()),
          std::copysign(half.z(), direction.z())};
}

Vector3 FurthestPoint(const Cylinder& cylinder, const Vector3& direction) {
  const double across = portable::Hypot(direction.x(), direction.y());
  const double part = across > 0 ? cylinder.radius_m / across : 0;
  return {part * direction.x(), part * direction.y(), std::copysign(cylinder.length_m / 2, direction.z())};
}

Vector3 FurthestPoint(const Sphere& sphere, const Vector3& direction) {
  return direction * (sphere.radius_m / direction.norm());
}

Vector3 FurthestPoint(const Capsule& capsule, const Vector3& direction) {
  return Vector3(0, 0, std::copysign(capsule.length_m / 2, direction.z())) +
         direction * (capsule.radius_m / direction.norm());
}

Vector3 Simplex::Reduce() {
  switch (count_) {
    case 1:
      return points_[0];
    case 2:
      return OfTwo();
    case 3:
      return OfThree();
    default:
      return OfFour();
  }
}

Vector3 Simplex::OfTwo() {
  const Vector3 &a = points_[0], &b = points_[1];
  const Vector3 e = b - a;
  const double t = -a.dot(e), length2 = e.squaredNorm();
  if (t <= 0 || length2 <= 0) {
    count_ = 1;
    return points_[0];
  }
  if (t >= length2) {
    points_[0] = points_[1];
    count_ = 1;
    return points_[0];
  }
  return a + (t / length2) * e;
}

Vector3 Simplex::OfThree() {
  const std::array<Vector3, 3> p{points_[0], points_[1], points_[2]};
  const Vector3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  const double size2 = normal.squaredNorm();
  bool is_inside = size2 > 0;
  for (std::size_t i = 0; i < 3 && is_inside; ++i) {
    const Vector3 &a = p[i], &b = p[(i + 1) % 3];
    is_inside = (b - a).cross(-a).dot(normal) >= 0;
  }
  if (is_inside) return normal * (normal.dot(p[0]) / size2);
  // The nearest point is on an edge.
  Simplex best;
  Vector3 nearest;
  double least = kNoHit;
  for (std::size_t i = 0; i < 3; ++i) {
    Simplex edge;
    edge.Add(p[i]);
    edge.Add(p[(i + 1) % 3]);
    const Vector3 of_edge = edge.OfTwo();
    if (of_edge.squaredNorm() >= least) continue;
    least = of_edge.squaredNorm();
    nearest = of_edge;
    best = edge;
  }
  *this = best;
  return nearest;
}

Vector3 Simplex::OfFour() {
  const std::array<Vector3, 4> p = points_;
  Simplex best;
  Vector3 nearest = Vector3::Zero();
  double least = kNoHit;
  bool is_inside = true;
  for (std::size_t apart = 0; apart < 4; ++apart) {
    const Vector3 &a = p[(apart + 1) % 4], &b = p[(apart + 2) % 4], &c = p[(apart + 3) % 4];
    const Vector3 normal = (b - a).cross(c - a);
    const double other = normal.dot(p[apart] - a), origin = -normal.dot(a);
    // The face separates the origin from the fourth point, or all four lie in a plane.
    if (other * origin > 0) continue;
    is_inside = false;
    Simplex face;
    face.Add(a);
    face.Add(b);
    face.Add(c);
    const Vector3 of_face = face.OfThree();
    if (of_face.squaredNorm() >= least) continue;
    least = of_face.squaredNorm();
    nearest = of_face;
    best = face;
  }
  if (is_inside) return Vector3::Zero();
  *this = best;
  return nearest;
}

}  // namespace coopdyn
