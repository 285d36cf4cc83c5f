// SPDX-License-Identifier: MIT
#include "server/geometry/ray.h"

#include <algorithm>
#include <cmath>

#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

constexpr double kSquare = 1e-18;  // sin² of an angle that counts as zero

// The part of a line inside a convex solid, computed as the intersection of slabs and quadrics.
struct Interval {
  double from = -kNoHit, to = kNoHit;

  bool empty() const { return from > to; }
  /// Keeps the part with |position + t * speed| ≤ half.
  void ClipSlab(double position, double speed, double half) {
    if (speed == 0) {
      if (std::abs(position) > half) to = -kNoHit;
      return;
    }
    const double a = (-half - position) / speed;
    const double b = (half - position) / speed;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  /// Keeps the part with a t² + 2 b t + c ≤ 0, a ≥ 0.
  void ClipQuadratic(double a, double b, double c) {
    if (a <= kSquare) {  // along the axis
      if (c > 0) to = -kNoHit;
      return;
    }
    const double discriminant = b * b - a * c;
    if (discriminant < 0) {
      to = -kNoHit;
      return;
    }
    const double root = std::sqrt(discriminant);
    from = std::max(from, (-b - root) / a);
    to = std::min(to, (-b + root) / a);
  }
  double FirstHit() const { return empty() || to < 0 ? kNoHit : std::max(from, 0.0); }
};

}  // namespace

double RayToBox(const Ray& ray, const Box& box) {
  Interval inside;
  for (int axis = 0; axis < 3; ++axis) {
    inside.ClipSlab(ray.origin[axis], ray.direction[axis], box.size_m[axis] / 2);
  }
  return inside.FirstHit();
}

double RayToCylinder(const Ray& ray, const Cylinder& cylinder) {
  const auto o = ray.origin.head<2>();
  const auto d = ray.direction.head<2>();
  Interval inside;
  inside.ClipSlab(ray.origin.z(), ray.direction.z(), cylinder.length_m / 2);
  inside.ClipQuadratic(d.squaredNorm(), o.dot(d), o.squaredNorm() - cylinder.radius_m * cylinder.radius_m);
  return inside.FirstHit();
}

double RayToCylinder(const Ray& ray, const Cylinder& cylinder, const Vector3& axis) {
  const double o_z = ray.origin.dot(axis);
  const double d_z = ray.direction.dot(axis);
  const Vector3 o = ray.origin - o_z * axis;
  const Vector3 d = ray.direction - d_z * axis;
  const double a = d.squaredNorm(), b = o.dot(d);
  const double c = o.squaredNorm() - cylinder.radius_m * cylinder.radius_m;
  const double half_m = cylinder.length_m / 2;
  if (c > 0 && a > kSquare) {
    // Most rays start outside and hit the lateral surface if at all; the end caps then need no test.
    const double discriminant = b * b - a * c;
    if (b >= 0 || discriminant < 0) return kNoHit;
    const double mantle = (-b - std::sqrt(discriminant)) / a;
    if (std::abs(o_z + mantle * d_z) <= half_m) return mantle;
  }
  Interval inside;
  inside.ClipSlab(o_z, d_z, half_m);
  inside.ClipQuadratic(a, b, c);
  return inside.FirstHit();
}

double RayToSphere(const Ray& ray, const Sphere& sphere) {
  Interval inside;
  inside.ClipQuadratic(1, ray.origin.dot(ray.direction),
                       ray.origin.squaredNorm() - sphere.radius_m * sphere.radius_m);
  return inside.FirstHit();
}

double RayToCapsule(const Ray& ray, const Capsule& capsule) {
  double nearest = RayToCylinder(ray, Cylinder{capsule.radius_m, capsule.length_m});
  for (const double end : {-0.5, 0.5}) {
    const Vector3 middle(0, 0, end * capsule.length_m);
    nearest = std::min(nearest, RayToSphere({ray.origin - middle, ray.direction}, Sphere{capsule.radius_m}));
  }
  return nearest;
}

double RayToShape(const Ray& ray, const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return RayToBox(ray, *box);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return RayToCylinder(ray, *cylinder);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return RayToSphere(ray, *sphere);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return RayToCapsule(ray, *capsule);
  return RayToMesh(ray, *std::get<Mesh>(shape).data);
}

double RayToFloor(const Ray& ray) {
  if (ray.origin.z() <= 0) return 0;
  return ray.direction.z() < 0 ? -ray.origin.z() / ray.direction.z() : kNoHit;
}

}  // namespace coopdyn
