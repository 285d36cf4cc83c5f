// SPDX-License-Identifier: MIT
#include "server/render/overlay.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coopdyn {

OverlayVertex Overlay::Corner(const Eigen::Vector4d& clip, double u, double v, const Rgba& color, int kind) {
  return {ToFloats<4>(clip.data()),
          {static_cast<float>(u), static_cast<float>(v)},
          ToFloats<4>(&color.r),
          static_cast<float>(kind)};
}

void Overlay::AddQuad(const std::array<OverlayVertex, 4>& corners) {
  for (const std::size_t i : {0, 1, 2, 0, 2, 3}) vertices_.push_back(corners[i]);
}

void Overlay::AddOnFloor(const Vector3& p_W, double radius_m, const Rgba& color, int kind) {
  const auto corner = [&](double u, double v) {
    return Corner(frustum_.Clip({p_W.x() + u * radius_m, p_W.y() + v * radius_m, 0}), u, v, color, kind);
  };
  AddQuad({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)});
}

void Overlay::AddTriangle(const Vector3& a_W, const Vector3& b_W, const Vector3& c_W, const Rgba& color) {
  for (const Vector3* p_W : {&a_W, &b_W, &c_W})
    vertices_.push_back(Corner(frustum_.Clip(*p_W), 0, 0, color, 0));
}

void Overlay::AddLine(const Vector3& from_W, const Vector3& to_W, double width_px, const Rgba& color) {
  Eigen::Vector4d a = frustum_.Clip(from_W), b = frustum_.Clip(to_W);
  const double near_m = frustum_.near_m();
  if (a.w() < near_m && b.w() < near_m) return;
  if (a.w() < near_m) a += (b - a) * ((near_m - a.w()) / (b.w() - a.w()));
  if (b.w() < near_m) b += (a - b) * ((near_m - b.w()) / (a.w() - b.w()));
  const Eigen::Array2d half_px(frustum_.width() / 2.0, frustum_.height() / 2.0);
  const Eigen::Vector2d along = (b.head<2>() / b.w() - a.head<2>() / a.w()).array() * half_px;
  if (along.norm() < 1e-9) return;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized() * (width_px / 2);
  const Eigen::Vector2d offset = across.array() / half_px;
  const auto corner = [&](const Eigen::Vector4d& end, double side) {
    Eigen::Vector4d clip = end;
    clip.head<2>() += offset * (side * end.w());
    return Corner(clip, 0, 0, color, 0);
  };
  AddQuad({corner(a, -1), corner(b, -1), corner(b, 1), corner(a, 1)});
}

void Overlay::AddDot(const Vector3& p_W, double radius_px, const Rgba& color, double lift_m) {
  const Vector3 to_eye_W = frustum_.eye_W() - p_W;
  const double distance_m = to_eye_W.norm();
  // Otherwise a slanted surface would hide half of the dot.
  const double slant_m = 1.5 * radius_px / frustum_.PixelsPerMetre(p_W);
  const double part = std::min((slant_m + lift_m) / distance_m, 0.5);
  const Eigen::Vector4d at = frustum_.Clip(p_W + part * to_eye_W);
  if (!(at.w() >= frustum_.near_m())) return;
  const double half_x = 2 * at.w() * radius_px / frustum_.width(),
               half_y = 2 * at.w() * radius_px / frustum_.height();
  if (std::abs(at.x()) > at.w() + half_x || std::abs(at.y()) > at.w() + half_y) return;
  // One triangle around the disc: there are many dots, and a square would need two.
  const auto corner = [&](double u, double v) {
    const Eigen::Vector4d clip = at + Eigen::Vector4d(u * half_x, v * half_y, 0, 0);
    vertices_.push_back(Corner(clip, u, v, color, 3));
  };
  corner(-std::numbers::sqrt3, -1);
  corner(std::numbers::sqrt3, -1);
  corner(0, 2);
}

}  // namespace coopdyn
