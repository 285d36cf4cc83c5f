// SPDX-License-Identifier: MIT
// Camera poses and projections. Pure; any thread. As in GL, a camera looks along −z of its frame.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "server/state/frame.h"
#include "server/state/image_board.h"
#include "server/state/scene.h"

namespace coopdyn {

using Matrix4 = Eigen::Matrix4d;

/// A perspective camera in the world.
struct Camera {
  Vector3 eye_W = Vector3(-3, -3, 3);
  Vector3 look_W = Vector3::Zero();
  double fov_rad = 0.8;  // full vertical angle
  double near_m = 0.05;
  double far_m = 100;
  std::optional<Matrix3> axes = std::nullopt;  // rows: right, up, backward in the world; instead of look_W
};

/// A pixel, where (0, 0) is the upper left corner of the picture, and the distance along the view direction.
struct ProjectedPoint {
  double x_px = 0, y_px = 0;
  double depth_m = 0;  // negative: behind the camera
};

/// World to camera. World z points up in the picture; for a camera that looks straight down, y does.
Matrix4 ViewMatrix(const Camera& camera);
/// Camera to clip coordinates.
Matrix4 ProjectionMatrix(const Camera& camera, int width, int height);

/// Projects points and tests the visibility of spheres.
class Frustum {
 public:
  Frustum(const Camera& camera, int width, int height);

  /// True if a part of the sphere may be in the picture.
  bool Sees(const Vector3& center_W, double radius_m) const;
  /// Approximate pixels per metre at `p_W`; large behind the camera.
  double PixelsPerMetre(const Vector3& p_W) const;
  Eigen::Vector4d Clip(const Vector3& p_W) const;
  ProjectedPoint Pixel(const Vector3& p_W) const;

  const Vector3& eye_W() const { return eye_W_; }
  double near_m() const { return near_m_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Matrix4 clip_from_W_;
  Vector3 eye_W_;
  std::array<Eigen::Vector4d, 6> planes_;  // inside: plane · (p, 1) ≥ 0
  double focal_px_ = 1;
  double near_m_ = 0.05;
  int width_, height_;
};

/// The camera of the scenario's [VIEW]; without one, a fixed camera that shows everything in `scene` at its
/// start (the floor if the scene is empty), from obliquely above.
Camera DefaultCamera(const Scene& scene, double fov_rad, int width, int height);
/// Camera `sensor` (index into the model's sensors) of a robot.
Camera CameraOf(const Frame& frame, int robot, std::size_t sensor);
/// The camera of `request`, with missing values from the default camera.
Camera CameraFor(const ImageRequest& request, const Scene& scene);

}  // namespace coopdyn
