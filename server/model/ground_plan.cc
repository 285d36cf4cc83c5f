// SPDX-License-Identifier: MIT
#include "server/model/ground_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

constexpr double kGap_m = 0.01;     // minimum horizontal gap
constexpr double kTouch_m = 0.001;  // allowed vertical overlap of stacked things

bool IsUpright(const Matrix3& R) {
  return std::abs(R(2, 2)) > 1 - 1e-9;
}

Standing StandingOf(const WorldObject& object) {
  Standing standing;
  standing.name = object.name;
  standing.where = object.where;
  const Matrix3 R = object.X_WO.q.toRotationMatrix();
  const Vector3& p = object.X_WO.p;
  const Vector3 half = HalfExtents(object.shape, object.X_WO.q);
  standing.x_m = p.x();
  standing.y_m = p.y();
  standing.low_m = p.z() - half.z();
  standing.high_m = p.z() + half.z();
  const auto* cylinder = std::get_if<Cylinder>(&object.shape);
  const auto* box = std::get_if<Box>(&object.shape);
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    standing.radius_m = sphere->radius_m;
  } else if (cylinder != nullptr && IsUpright(R)) {
    standing.radius_m = cylinder->radius_m;
  } else if (box != nullptr && IsUpright(R)) {
    standing.half_length_m = box->size_m.x() / 2;
    standing.half_width_m = box->size_m.y() / 2;
    standing.yaw_rad = portable::Atan2(R(1, 0), R(0, 0));
  } else {
    standing.half_length_m = half.x();
    standing.half_width_m = half.y();
  }
  return standing;
}

Standing StandingOf(const RobotEntry& robot) {
  Standing standing;
  standing.name = robot.name;
  standing.where = robot.where;
  const Vector3& p = robot.X_WR.p;
  const double radius_m = robot.model->footprint_radius_m, height_m = robot.model->height_m;
  standing.x_m = p.x();
  standing.y_m = p.y();
  if (const Matrix3 R = robot.X_WR.q.toRotationMatrix(); IsUpright(R) && R(2, 2) > 0) {
    standing.radius_m = radius_m;
    standing.low_m = p.z();
    standing.high_m = p.z() + height_m;
  } else {
    standing.radius_m = portable::Hypot(radius_m, height_m);
    standing.low_m = p.z() - standing.radius_m;
    standing.high_m = p.z() + standing.radius_m;
  }
  return standing;
}

/// The extent of `one` from its centre along the direction (x, y).
double Reach(const Standing& one, double x, double y) {
  if (one.radius_m > 0) return one.radius_m;
  const auto [s, c] = portable::SinCos(one.yaw_rad);
  return one.half_length_m * std::abs(c * x + s * y) + one.half_width_m * std::abs(c * y - s * x);
}

/// The distance of a point from a rectangle; 0 inside.
double Distance(const Standing& rectangle, double x_m, double y_m) {
  const double dx = x_m - rectangle.x_m, dy = y_m - rectangle.y_m;
  const auto [s, c] = portable::SinCos(rectangle.yaw_rad);
  const double along = std::abs(c * dx + s * dy) - rectangle.half_length_m;
  const double across = std::abs(c * dy - s * dx) - rectangle.half_width_m;
  return portable::Hypot(std::max(0.0, along), std::max(0.0, across));
}

bool ShadowsOverlap(const Standing& a, const Standing& b) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  if (a.radius_m > 0 && b.radius_m > 0) return portable::Hypot(dx, dy) < a.radius_m + b.radius_m + kGap_m;
  if (a.radius_m > 0) return Distance(b, a.x_m, a.y_m) < a.radius_m + kGap_m;
  if (b.radius_m > 0) return Distance(a, b.x_m, b.y_m) < b.radius_m + kGap_m;
  // Two rectangles are apart if a direction along a side of either separates them.
  constexpr double kQuarter = 1.57079632679489662;
  const std::array<double, 4> angles = {a.yaw_rad, a.yaw_rad + kQuarter, b.yaw_rad, b.yaw_rad + kQuarter};
  return std::ranges::all_of(angles, [&](double angle) {
    const auto [y, x] = portable::SinCos(angle);
    return std::abs(dx * x + dy * y) < Reach(a, x, y) + Reach(b, x, y) + kGap_m;
  });
}

}  // namespace

std::vector<Standing> GroundPlan(const Scenario& scenario) {
  std::vector<Standing> all;
  for (const WorldObject& object : scenario.objects) all.push_back(StandingOf(object));
  for (const RobotEntry& robot : scenario.robots) {
    if (robot.model != nullptr) all.push_back(StandingOf(robot));
  }
  return all;
}

bool Overlap(const Standing& a, const Standing& b) {
  if (a.where == b.where) return false;  // e.g. a team and its bar
  if (a.low_m + kTouch_m >= b.high_m || b.low_m + kTouch_m >= a.high_m) return false;
  return ShadowsOverlap(a, b);
}

}  // namespace coopdyn
