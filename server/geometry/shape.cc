// SPDX-License-Identifier: MIT
#include "server/geometry/shape.h"

#include <cmath>
#include <numbers>

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
  return std::atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
}

double WrapAngle(double angle_rad) {
  if (angle_rad > -std::numbers::pi && angle_rad <= std::numbers::pi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? wrapped + 2 * std::numbers::pi : wrapped;
}

double BoundingRadius(const Shape& shape) {
  return std::visit(Overloaded{[](const Box& box) { return box.size_m.norm() / 2; },
                               [](const Cylinder& c) { return std::hypot(c.radius_m, c.length_m / 2); },
                               [](const Sphere& s) { return s.radius_m; }},
                    shape);
}

Vector3 HalfExtents(const Shape& shape, const Quaternion& q) {
  return HalfExtents(shape, Matrix3(q.toRotationMatrix()));
}

Vector3 HalfExtents(const Shape& shape, const Matrix3& R) {
  return std::visit(Overloaded{[&](const Box& box) -> Vector3 { return R.cwiseAbs() * (box.size_m / 2); },
                               [&](const Cylinder& c) -> Vector3 {
                                 const Vector3 axis = R.col(2);
                                 const Vector3 across =
                                     (Vector3::Ones() - axis.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
                                 return axis.cwiseAbs() * (c.length_m / 2) + across * c.radius_m;
                               },
                               [](const Sphere& s) -> Vector3 { return Vector3::Constant(s.radius_m); }},
                    shape);
}

double Volume(const Shape& shape) {
  constexpr double kPi = std::numbers::pi;
  return std::visit(
      Overloaded{[](const Box& box) { return box.size_m.prod(); },
                 [](const Cylinder& c) { return kPi * c.radius_m * c.radius_m * c.length_m; },
                 [](const Sphere& s) { return 4.0 / 3.0 * kPi * s.radius_m * s.radius_m * s.radius_m; }},
      shape);
}

Vector3 SolidInertia(const Shape& shape, double mass_kg) {
  return std::visit(Overloaded{[&](const Box& box) -> Vector3 {
                                 const Vector3 s2 = box.size_m.cwiseAbs2();
                                 return mass_kg / 12 *
                                        Vector3(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y());
                               },
                               [&](const Cylinder& c) -> Vector3 {
                                 const double r2 = c.radius_m * c.radius_m;
                                 const double across = mass_kg / 12 * (3 * r2 + c.length_m * c.length_m);
                                 return {across, across, mass_kg * r2 / 2};
                               },
                               [&](const Sphere& s) -> Vector3 {
                                 return Vector3::Constant(0.4 * mass_kg * s.radius_m * s.radius_m);
                               }},
                    shape);
}

}  // namespace coopdyn
