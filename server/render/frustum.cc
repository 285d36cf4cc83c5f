// SPDX-License-Identifier: MIT
#include "server/render/frustum.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

Frustum::Frustum(const Camera& camera, int width, int height)
    : clip_from_W_(ProjectionMatrix(camera, width, height) * ViewMatrix(camera)),
      focal_px_(height / 2.0 / std::tan(camera.fov_rad / 2)),
      near_m_(camera.near_m),
      width_(width),
      height_(height) {
  const Eigen::Vector4d w = clip_from_W_.row(3);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector4d along = clip_from_W_.row(axis);
    planes_[2 * static_cast<std::size_t>(axis)] = w + along;
    planes_[2 * static_cast<std::size_t>(axis) + 1] = w - along;
  }
  for (Eigen::Vector4d& plane : planes_) plane /= plane.head<3>().norm();
}

bool Frustum::Sees(const Vector3& center_W, double radius_m) const {
  return std::all_of(planes_.begin(), planes_.end(), [&](const Eigen::Vector4d& plane) {
    return plane.head<3>().dot(center_W) + plane.w() >= -radius_m;
  });
}

double Frustum::PixelsPerMetre(const Vector3& p_W) const {
  return focal_px_ / std::max(Clip(p_W).w(), near_m_);
}

Eigen::Vector4d Frustum::Clip(const Vector3& p_W) const {
  return clip_from_W_.leftCols<3>() * p_W + clip_from_W_.col(3);
}

ProjectedPoint Frustum::Pixel(const Vector3& p_W) const {
  const Eigen::Vector4d clip = Clip(p_W);
  return {(clip.x() / clip.w() + 1) / 2 * width_, (1 - clip.y() / clip.w()) / 2 * height_, clip.w()};
}

}  // namespace coopdyn
