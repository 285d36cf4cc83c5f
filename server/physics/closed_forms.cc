// SPDX-License-Identifier: MIT
#include "server/physics/closed_forms.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/base/portable_math.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

constexpr double kLyingWheel = 0.7;  // |cosine| between axle and normal beyond which a wheel does not roll

/// The point of a disc about `axis` that is furthest against `normal`.
Vector3 LowestOfDisc(const Vector3& centre, const Vector3& axis, double radius_m, const Vector3& normal) {
  return centre - radius_m * (normal - normal.dot(axis) * axis).normalized();
}

struct Overlap {
  double depth_m;   // ≤ 0: none
  double middle_m;  // height of its middle
};

Overlap OfHeights(double z_a, double half_a, double z_b, double half_b) {
  const double top = std::min(z_a + half_a, z_b + half_b);
  const double bottom = std::max(z_a - half_a, z_b - half_b);
  return {top - bottom, (top + bottom) / 2};
}

const ClosedForm kNoContact{true, std::nullopt};
const ClosedForm kDoesNotApply{false, std::nullopt};

}  // namespace

bool PlacedRotation::upright() const {
  return std::abs(R[10]) > 0.9995;
}

PlacedPart::PlacedPart(const Part& of, const BodyState& body) : part(&of) {
  for (int row = 0; row < 3; ++row) {
    const double* r = body.R_WB.data() + 3 * row;
    p[row] = body.p_WB[row] + r[0] * of.p_BG.x() + r[1] * of.p_BG.y() + r[2] * of.p_BG.z();
    for (int column = 0; column < 3; ++column) {
      R[4 * row + column] = r[0] * of.R_BG(0, column) + r[1] * of.R_BG(1, column) + r[2] * of.R_BG(2, column);
    }
    R[4 * row + 3] = 0;
  }
  if (const Box* box = std::get_if<Box>(&of.shape)) {
    for (int row = 0; row < 3; ++row) {
      const double* r = R + 4 * row;
      half_m[row] = (std::abs(r[0]) * box->size_m.x() + std::abs(r[1]) * box->size_m.y() +
                     std::abs(r[2]) * box->size_m.z()) /
                    2;
    }
  } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&of.shape)) {
    for (int row = 0; row < 3; ++row) {
      const double along = std::abs(R[4 * row + 2]);
      half_m[row] =
          along * cylinder->length_m / 2 + std::sqrt(std::max(0.0, 1 - along * along)) * cylinder->radius_m;
    }
  } else if (const Sphere* sphere = std::get_if<Sphere>(&of.shape)) {
    half_m.setConstant(sphere->radius_m);
  } else {
    Matrix3 R_WG;
    for (int row = 0; row < 3; ++row) R_WG.row(row) << R[4 * row], R[4 * row + 1], R[4 * row + 2];
    half_m = HalfExtents(of.shape, R_WG);
  }
}

ClosedForm WheelOnFloor(double radius_m, const PlacedRotation& wheel, double margin_m) {
  const Vector3 axle = wheel.axis(2);
  if (std::abs(axle.z()) > kLyingWheel) return kDoesNotApply;
  if (wheel.p[2] > radius_m + margin_m) return kNoContact;
  const Vector3 p = LowestOfDisc(wheel.position(), axle, radius_m, Vector3::UnitZ());
  if (-p.z() <= -margin_m) return kNoContact;
  return {true, ContactPoint{p, Vector3::UnitZ(), -p.z()}};
}

ClosedForm WheelOnBox(double radius_m, const PlacedRotation& wheel, const Box& box,
                      const PlacedRotation& X_WB, double margin_m) {
  const Vector3 from_box = wheel.position() - X_WB.position();
  int top = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(X_WB.R[8 + i]) > std::abs(X_WB.R[8 + top])) top = i;
  }
  const Vector3 normal = X_WB.axis(top) * (X_WB.R[8 + top] > 0 ? 1 : -1);
  const Vector3 axle = wheel.axis(2);
  if (normal.z() < 0.5 || std::abs(normal.dot(axle)) > kLyingWheel) return kDoesNotApply;
  const Vector3 p = LowestOfDisc(wheel.position(), axle, radius_m, normal);
  const Vector3 p_from_box = p - X_WB.position();
  for (int i = 0; i < 3; ++i) {
    if (i != top && std::abs(p_from_box.dot(X_WB.axis(i))) > box.size_m[i] / 2) return kDoesNotApply;
  }
  const double half = box.size_m[top] / 2;
  const double depth = half - p_from_box.dot(normal);
  if (depth <= -margin_m) return kNoContact;
  if (depth > radius_m / 2 || from_box.dot(normal) < half) return kDoesNotApply;
  return {true, ContactPoint{p, normal, depth}};
}

ClosedForm UprightCylinders(const Cylinder& a, const PlacedRotation& X_WA, const Cylinder& b,
                            const PlacedRotation& X_WB, double margin_m) {
  if (!X_WA.upright() || !X_WB.upright()) return kDoesNotApply;
  const Overlap height = OfHeights(X_WA.p[2], a.length_m / 2, X_WB.p[2], b.length_m / 2);
  if (height.depth_m <= -kAhead_m) return kNoContact;
  const double dx = X_WA.p[0] - X_WB.p[0];
  const double dy = X_WA.p[1] - X_WB.p[1];
  const double distance = portable::Hypot(dx, dy);
  const double depth = a.radius_m + b.radius_m - distance;
  if (depth <= -margin_m) return kNoContact;
  if (height.depth_m < depth) return kDoesNotApply;
  if (height.depth_m <= 0) return kNoContact;
  const Vector3 n = distance > 0 ? Vector3(dx / distance, dy / distance, 0) : Vector3::UnitX();
  const double along = b.radius_m - depth / 2;
  return {true,
          ContactPoint{{X_WB.p[0] + along * n.x(), X_WB.p[1] + along * n.y(), height.middle_m}, n, depth}};
}

ClosedForm UprightCylinderAndBox(const Cylinder& a, const PlacedRotation& X_WA, const Box& b,
                                 const PlacedRotation& X_WB, double margin_m) {
  if (!X_WA.upright() || !X_WB.upright()) return kDoesNotApply;
  const Overlap height = OfHeights(X_WA.p[2], a.length_m / 2, X_WB.p[2], b.size_m.z() / 2);
  if (height.depth_m <= -kAhead_m) return kNoContact;
  // In the plane, along the box's x and y axes.
  const Vector3 x_axis = Vector3(X_WB.R[0], X_WB.R[4], 0).normalized();
  const Vector3 y_axis(-x_axis.y(), x_axis.x(), 0);
  const Vector3 d = X_WA.position() - X_WB.position();
  const double x = d.dot(x_axis), y = d.dot(y_axis);
  const double hx = b.size_m.x() / 2, hy = b.size_m.y() / 2;
  const double beyond_x = x - std::clamp(x, -hx, hx), beyond_y = y - std::clamp(y, -hy, hy);
  double n_x = 0, n_y = 0, depth = 0;
  if (beyond_x != 0 || beyond_y != 0) {
    const double distance = portable::Hypot(beyond_x, beyond_y);
    depth = a.radius_m - distance;
    if (depth <= -margin_m) return kNoContact;
    n_x = beyond_x / distance;
    n_y = beyond_y / distance;
  } else if (hx - std::abs(x) < hy - std::abs(y)) {
    n_x = x < 0 ? -1 : 1;
    depth = a.radius_m + hx - std::abs(x);
  } else {
    n_y = y < 0 ? -1 : 1;
    depth = a.radius_m + hy - std::abs(y);
  }
  if (height.depth_m < depth) return kDoesNotApply;
  if (height.depth_m <= 0) return kNoContact;
  const Vector3 n = n_x * x_axis + n_y * y_axis;
  Vector3 p = X_WA.position() - (a.radius_m - depth / 2) * n;
  p.z() = height.middle_m;
  return {true, ContactPoint{p, n, depth}};
}

ClosedForm SphereAndSphere(const Sphere& a, const Vector3& p_WA, const Sphere& b, const Vector3& p_WB,
                           double margin_m) {
  const Vector3 between = p_WA - p_WB;
  const double distance = between.norm(), depth = a.radius_m + b.radius_m - distance;
  if (depth <= -margin_m) return kNoContact;
  if (distance == 0) return kDoesNotApply;
  const Vector3 n = between / distance;
  return {true, ContactPoint{p_WB + (b.radius_m - depth / 2) * n, n, depth}};
}

ClosedForm SphereAndBox(const Sphere& a, const Vector3& p_WA, const Box& b, const PlacedRotation& X_WB,
                        double margin_m) {
  const Vector3 d = p_WA - X_WB.position();
  const Vector3 centre(d.dot(X_WB.axis(0)), d.dot(X_WB.axis(1)), d.dot(X_WB.axis(2)));
  const Vector3 nearest = centre.cwiseMax(-b.size_m / 2).cwiseMin(b.size_m / 2);
  const double distance = (centre - nearest).norm(), depth = a.radius_m - distance;
  if (depth <= -margin_m) return kNoContact;
  if (distance == 0) return kDoesNotApply;
  const Vector3 p = X_WB.point(nearest);
  return {true, ContactPoint{p, (p_WA - p) / distance, depth}};
}

double DepthInside(const Shape& shape, const PlacedRotation& X_WS, const Vector3& point) {
  const Vector3 d = point - X_WS.position();
  const Vector3 local(d.dot(X_WS.axis(0)), d.dot(X_WS.axis(1)), d.dot(X_WS.axis(2)));
  if (const Box* box = std::get_if<Box>(&shape)) return (box->size_m / 2 - local.cwiseAbs()).minCoeff();
  if (const Cylinder* c = std::get_if<Cylinder>(&shape)) {
    return std::min(c->radius_m - portable::Hypot(local.x(), local.y()),
                    c->length_m / 2 - std::abs(local.z()));
  }
  if (const Sphere* sphere = std::get_if<Sphere>(&shape)) return sphere->radius_m - local.norm();
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
    const double beyond = std::max(0.0, std::abs(local.z()) - capsule->length_m / 2);
    return capsule->radius_m - Vector3(local.x(), local.y(), beyond).norm();
  }
  return -std::get<Mesh>(shape).data->radius_m;  // a mesh has no inside: only its triangles touch
}

}  // namespace coopdyn
