// SPDX-License-Identifier: MIT
#include "server/geometry/cone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "server/base/portable_math.h"
#include "server/geometry/convex_overlap.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

constexpr double kEnough_m = 2e-6;  // resolution of the search for the distance

/// A cone whose apex is the origin.
struct OpenCone {
  Vector3 axis;
  double sine, cosine;

  explicit OpenCone(const Cone& cone)
      : axis(cone.axis),
        sine(portable::Sin(cone.half_angle_rad)),
        cosine(portable::Cos(cone.half_angle_rad)) {}

  bool Holds(const Vector3& p) const {
    const double along = p.dot(axis);
    const double across = (p - along * axis).norm();
    return along * sine - across * cosine >= -1e-9 * (1 + p.norm());
  }
  bool MeetsSphere(const Vector3& middle, double radius_m) const {
    const double along = middle.dot(axis);
    const double across = (middle - along * axis).norm();
    if (along * cosine + across * sine <= 0) return middle.squaredNorm() <= radius_m * radius_m;
    return across * cosine - along * sine <= radius_m;
  }
};

/// The part of a cone within a sphere about its apex, which is the origin.
struct Sector {
  const OpenCone& cone;
  double radius_m;

  Vector3 Support(const Vector3& direction) const {
    const double along = direction.dot(cone.axis);
    const Vector3 across = direction - along * cone.axis;
    const double width = across.norm();
    if (along * cone.sine >= width * cone.cosine) return direction * (radius_m / direction.norm());
    const Vector3 rim = cone.cosine * cone.axis + across * (cone.sine / width);
    return rim.dot(direction) > 0 ? Vector3(radius_m * rim) : Vector3::Zero();
  }
};

/// A solid centred at `middle`.
template <typename Solid>
struct Moved {
  const Solid& solid;
  Vector3 middle;

  Vector3 Support(const Vector3& direction) const { return middle + FurthestPoint(solid, direction); }
};

template <typename Solid>
double SolidInCone(const OpenCone& cone, const Solid& solid, const Vector3& middle, double limit_m) {
  const Moved<Solid> moved{solid, middle};
  const auto is_within = [&](double radius_m) { return Overlap(moved, Sector{cone, radius_m}, middle); };
  if (!is_within(limit_m)) return kNoHit;
  double outside = 0, inside = limit_m;
  while (inside - outside > kEnough_m) {
    const double half = (outside + inside) / 2;
    (is_within(half) ? inside : outside) = half;
  }
  return inside <= kEnough_m ? 0 : inside;
}

/// The point of a triangle nearest to the origin.
Vector3 NearestOf(const std::array<Vector3, 3>& corners) {
  Simplex simplex;
  for (const Vector3& corner : corners) simplex.Add(corner);
  return simplex.Reduce();
}

/// The distance from the origin to the part of edge `a` `b` within the cone. That part is one segment, so its
/// nearest point is the edge's own nearest point or an end of the segment.
double EdgeInCone(const OpenCone& cone, const Vector3& a, const Vector3& b) {
  const Vector3 e = b - a;
  const double length2 = e.squaredNorm(), cosine2 = cone.cosine * cone.cosine;
  double nearest = kNoHit;
  const auto consider = [&](double s) {
    const Vector3 p = a + std::clamp(s, 0.0, 1.0) * e;
    if (cone.Holds(p)) nearest = std::min(nearest, p.norm());
  };
  consider(0);
  consider(1);
  if (length2 <= 0) return nearest;
  consider(-a.dot(e) / length2);
  const double a_x = a.dot(cone.axis), e_x = e.dot(cone.axis);
  const double square = e_x * e_x - cosine2 * length2, middle = a_x * e_x - cosine2 * a.dot(e),
               constant = a_x * a_x - cosine2 * a.squaredNorm();
  const double discriminant = middle * middle - square * constant;
  if (discriminant < 0 || square == 0) return nearest;
  const double root = std::sqrt(discriminant);
  for (const double s : {(-middle - root) / square, (-middle + root) / square}) {
    if (s >= 0 && s <= 1) consider(s);
  }
  return nearest;
}

/// The distance to the nearest point of a triangle within the cone: the triangle's own nearest point, a point
/// on an edge, or the point where its plane is nearest along the cone's surface.
double TriangleInCone(const OpenCone& cone, const std::array<Vector3, 3>& corners, double limit_m) {
  const Vector3 nearest_point = NearestOf(corners);
  const double least_m = nearest_point.norm();
  if (least_m >= limit_m) return kNoHit;
  if (cone.Holds(nearest_point)) return least_m;
  double nearest = kNoHit;
  for (std::size_t i = 0; i < 3; ++i)
    nearest = std::min(nearest, EdgeInCone(cone, corners[i], corners[(i + 1) % 3]));
  Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (normal.dot(corners[0]) < 0) normal = -normal;
  const Vector3 across = normal - normal.dot(cone.axis) * cone.axis;
  if (const double width = across.norm(); width > 0) {
    const Ray mantle{Vector3::Zero(), cone.cosine * cone.axis + across * (cone.sine / width)};
    nearest = std::min(nearest, RayToTriangle(mantle, corners[0], corners[1], corners[2]));
  }
  return nearest;
}

/// The squared distance from the origin to a box.
double SquareToBox(const Vector3& low, const Vector3& high) {
  return low.cwiseMax(0).cwiseMax(-high).squaredNorm();
}

double MeshInCone(const OpenCone& cone, const MeshData& mesh, const Vector3& apex, double limit_m) {
  double nearest = std::nextafter(limit_m, kNoHit);
  const RayTree& tree = mesh.tree;
  std::array<std::uint32_t, RayTree::kStack> stack{};
  std::size_t waiting = tree.nodes().empty() ? 0 : 1;
  while (waiting > 0) {
    const RayTree::Node& node = tree.nodes()[stack[--waiting]];
    for (std::size_t i = 0; i < 4; ++i) {
      if (node.is_empty(i)) continue;
      const Vector3 low = node.low(i).cast<double>() - apex, high = node.high(i).cast<double>() - apex;
      if (SquareToBox(low, high) > nearest * nearest) continue;
      if (!cone.MeetsSphere((low + high) / 2, (high - low).norm() / 2)) continue;
      if (node.count[i] == 0) {
        stack[waiting++] = node.child[i];
        continue;
      }
      for (std::uint32_t k = node.child[i]; k < node.child[i] + node.count[i]; ++k) {
        const auto& [a, b, c] = tree.triangles()[k];
        nearest = std::min(
            nearest,
            TriangleInCone(cone, {mesh.vertices[a] - apex, mesh.vertices[b] - apex, mesh.vertices[c] - apex},
                           nearest));
      }
    }
  }
  return nearest <= limit_m ? nearest : kNoHit;
}

}  // namespace

bool ConeMeetsSphere(const Cone& cone, const Vector3& middle, double radius_m) {
  return OpenCone(cone).MeetsSphere(middle - cone.apex, radius_m);
}

double NearestInCone(const Cone& cone, const Shape& shape, double limit_m) {
  const OpenCone open(cone);
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return MeshInCone(open, *mesh->data, cone.apex, limit_m);
  if (!open.MeetsSphere(-cone.apex, BoundingRadius(shape))) return kNoHit;
  return std::visit(
      [&]<typename Solid>(const Solid& solid) {
        if constexpr (std::is_same_v<Solid, Mesh>) {
          return kNoHit;
        } else {
          return SolidInCone(open, solid, -cone.apex, limit_m);
        }
      },
      shape);
}

}  // namespace coopdyn
