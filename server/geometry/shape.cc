// SPDX-License-Identifier: MIT
#include "server/geometry/shape.h"

#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

template <typename... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <typename... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;

}  // namespace

double Heading(const Quaternion& q) {
  return portable::Atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
}

Vector3 ToRollPitchYaw(const Quaternion& q) {
  const Matrix3 R = q.toRotationMatrix();
  // If x points up or down (gimbal lock), roll and yaw are one rotation; set roll to 0.
  constexpr double kUpright = 1e-9;
  if (std::abs(R(0, 0)) + std::abs(R(1, 0)) < kUpright)
    return {0, std::copysign(std::numbers::pi / 2, -R(2, 0)), portable::Atan2(-R(0, 1), R(1, 1))};
  return {portable::Atan2(R(2, 1), R(2, 2)), portable::Asin(std::clamp(-R(2, 0), -1.0, 1.0)),
          portable::Atan2(R(1, 0), R(0, 0))};
}

double WrapAngle(double angle_rad) {
  if (angle_rad > -std::numbers::pi && angle_rad <= std::numbers::pi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? wrapped + 2 * std::numbers::pi : wrapped;
}

double BoundingRadius(const Shape& shape) {
  return std::visit(Overloaded{[](const Box& box) { return box.size_m.norm() / 2; },
                               [](const Cylinder& c) { return portable::Hypot(c.radius_m, c.length_m / 2); },
                               [](const Sphere& s) { return s.radius_m; },
                               [](const Capsule& c) { return c.radius_m + c.length_m / 2; },
                               [](const Mesh& m) { return m.data->radius_m; }},
                    shape);
}

Vector3 HalfExtents(const Shape& shape, const Quaternion& q) {
  return HalfExtents(shape, Matrix3(q.toRotationMatrix()));
}

Vector3 HalfExtents(const Shape& shape, const Matrix3& R) {
  return std::visit(
      Overloaded{[&](const Box& box) -> Vector3 { return R.cwiseAbs() * (box.size_m / 2); },
                 [&](const Cylinder& c) -> Vector3 {
                   const Vector3 axis = R.col(2);
                   const Vector3 across = (Vector3::Ones() - axis.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
                   return axis.cwiseAbs() * (c.length_m / 2) + across * c.radius_m;
                 },
                 [](const Sphere& s) -> Vector3 { return Vector3::Constant(s.radius_m); },
                 [&](const Capsule& c) -> Vector3 {
                   return R.col(2).cwiseAbs() * (c.length_m / 2) + Vector3::Constant(c.radius_m);
                 },
                 [&](const Mesh& m) -> Vector3 { return R.cwiseAbs() * m.data->half_m; }},
      shape);
}

double Volume(const Shape& shape) {
  constexpr double kPi = std::numbers::pi;
  return std::visit(
      Overloaded{[](const Box& box) { return box.size_m.prod(); },
                 [](const Cylinder& c) { return kPi * c.radius_m * c.radius_m * c.length_m; },
                 [](const Sphere& s) { return 4.0 / 3.0 * kPi * s.radius_m * s.radius_m * s.radius_m; },
                 [](const Capsule& c) {
                   return kPi * c.radius_m * c.radius_m * (c.length_m + 4.0 / 3.0 * c.radius_m);
                 },
                 [](const Mesh& m) { return std::abs(m.data->volume_m3); }},
      shape);
}

Vector3 SolidInertia(const Shape& shape, double mass_kg) {
  return std::visit(
      Overloaded{[&](const Box& box) -> Vector3 {
                   const Vector3 s2 = box.size_m.cwiseAbs2();
                   return mass_kg / 12 * Vector3(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y());
                 },
                 [&](const Cylinder& c) -> Vector3 {
                   const double r2 = c.radius_m * c.radius_m;
                   const double across = mass_kg / 12 * (3 * r2 + c.length_m * c.length_m);
                   return {across, across, mass_kg * r2 / 2};
                 },
                 [&](const Sphere& s) -> Vector3 {
                   return Vector3::Constant(0.4 * mass_kg * s.radius_m * s.radius_m);
                 },
                 [&](const Capsule& c) -> Vector3 {
                   const double r = c.radius_m, h = c.length_m;
                   const double ends_kg = mass_kg * 4 * r / (4 * r + 3 * h);
                   const double middle_kg = mass_kg - ends_kg;
                   const double across = middle_kg * (r * r / 4 + h * h / 12) +
                                         ends_kg * (0.4 * r * r + h * h / 4 + 3.0 / 8 * h * r);
                   return {across, across, r * r * (middle_kg / 2 + 0.4 * ends_kg)};
                 },
                 [&](const Mesh& m) -> Vector3 {
                   // An open or inside-out mesh counts as its box.
                   if (m.data->volume_m3 > 0 && m.data->inertia_m5.minCoeff() > 0)
                     return m.data->inertia_m5 * (mass_kg / m.data->volume_m3);
                   const Vector3 s2 = 4 * m.data->half_m.cwiseAbs2();
                   return mass_kg / 12 * Vector3(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y());
                 }},
      shape);
}

}  // namespace coopdyn
