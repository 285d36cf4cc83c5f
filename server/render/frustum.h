// SPDX-License-Identifier: MIT
// What a camera sees of points and spheres. Pure; any thread.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "server/render/camera.h"

namespace coopdyn {

class Frustum {
 public:
  Frustum(const Camera& camera, int width, int height);

  /// True if a part of the sphere may be in the picture.
  bool Sees(const Vector3& center_W, double radius_m) const;
  /// About how many pixels a length of 1 m at `p_W` covers; large behind the camera.
  double PixelsPerMetre(const Vector3& p_W) const;
  Eigen::Vector4d Clip(const Vector3& p_W) const;
  ProjectedPoint Pixel(const Vector3& p_W) const;

  double near_m() const { return near_m_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Matrix4 clip_from_W_;
  std::array<Eigen::Vector4d, 6> planes_;  // inside: plane · (p, 1) ≥ 0
  double focal_px_ = 1;
  double near_m_ = 0.05;
  int width_, height_;
};

}  // namespace coopdyn
