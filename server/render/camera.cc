// SPDX-License-Identifier: MIT
#include "server/render/camera.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

struct Bounds {
  Vector3 min = Vector3::Constant(1e30), max = Vector3::Constant(-1e30);

  bool empty() const { return min.x() > max.x(); }
  Vector3 center() const { return (min + max) / 2; }
  Vector3 corner(int i) const {
    return {i & 1 ? max.x() : min.x(), i & 2 ? max.y() : min.y(), i & 4 ? max.z() : min.z()};
  }
  void Add(const Vector3& p, const Vector3& half) {
    min = min.cwiseMin(p - half);
    max = max.cwiseMax(p + half);
  }
};

Bounds FloorBounds(const Floor& floor) {
  Bounds bounds;
  bounds.Add(Vector3::Zero(), {floor.length_m / 2, floor.width_m / 2, 0});
  return bounds;
}

Bounds ContentBounds(const Scene& scene) {
  constexpr double kMargin_m = 0.5;
  Bounds bounds;
  for (const SceneObject& object : scene.objects) {
    bounds.Add(object.object.X_WO.p, HalfExtents(object.object.shape, object.object.X_WO.q));
  }
  for (const SceneRobot& robot : scene.robots) {
    const double r = robot.entry.model->footprint_radius_m + kMargin_m;
    bounds.Add(robot.entry.X_WR.p, {r, r, 0});
    bounds.max.z() = std::max(bounds.max.z(), robot.entry.X_WR.p.z() + robot.entry.model->height_m);
  }
  for (const Target& target : scene.targets) bounds.Add(target.p_WT, {kMargin_m, kMargin_m, 0});
  if (bounds.empty()) return FloorBounds(scene.floor);
  bounds.min.z() = 0;
  bounds.max.z() = std::max(bounds.max.z(), 0.3);
  return bounds;
}

// Rows: right, up and backward of the camera in the world.
Matrix3 CameraAxes(const Vector3& backward) {
  const Vector3 z = backward.normalized();
  const Vector3 up = std::abs(z.z()) > 0.9999 ? Vector3::UnitY() : Vector3::UnitZ();
  const Vector3 x = up.cross(z).normalized();
  Matrix3 axes;
  axes << x.transpose(), z.cross(x).transpose(), z.transpose();
  return axes;
}

// Moves a camera that looks along −axes.row(2) so that `bounds` just fill the picture; returns the eye.
Vector3 FitEye(const Bounds& bounds, const Matrix3& axes, double tan_x, double tan_y) {
  // In the plane through right and forward, and through up and forward, the eye is the apex of a wedge that
  // touches the corners on both sides; the farther apex of the two wins.
  double back[2], across[2];
  const double tans[2] = {tan_x, tan_y};
  for (int axis = 0; axis < 2; ++axis) {
    double high = -1e30, low = -1e30;
    for (int i = 0; i < 8; ++i) {
      const Vector3 c = axes * bounds.corner(i);
      high = std::max(high, c[axis] + tans[axis] * c.z());
      low = std::max(low, -c[axis] + tans[axis] * c.z());
    }
    across[axis] = (high - low) / 2;
    back[axis] = (high + low) / (2 * tans[axis]);
  }
  const double farther = std::max(back[0], back[1]);
  return axes.transpose() * Vector3(across[0], across[1], farther);
}

}  // namespace

Matrix4 ViewMatrix(const Camera& camera) {
  const Matrix3 axes = CameraAxes(camera.eye_W - camera.look_W);
  Matrix4 view = Matrix4::Identity();
  view.topLeftCorner<3, 3>() = axes;
  view.topRightCorner<3, 1>() = -axes * camera.eye_W;
  return view;
}

Matrix4 ProjectionMatrix(const Camera& camera, int width, int height) {
  const double f = 1 / std::tan(camera.fov_rad / 2);
  const double n = camera.near_m, d = camera.far_m;
  Matrix4 projection = Matrix4::Zero();
  projection(0, 0) = f * height / width;
  projection(1, 1) = f;
  projection(2, 2) = (d + n) / (n - d);
  projection(2, 3) = 2 * d * n / (n - d);
  projection(3, 2) = -1;
  return projection;
}

ProjectedPoint Project(const Camera& camera, int width, int height, const Vector3& p_W) {
  const Eigen::Vector4d clip = ProjectionMatrix(camera, width, height) * ViewMatrix(camera) *
                               Eigen::Vector4d(p_W.x(), p_W.y(), p_W.z(), 1);
  return {(clip.x() / clip.w() + 1) / 2 * width, (1 - clip.y() / clip.w()) / 2 * height, clip.w()};
}

Camera DefaultCamera(const Scene& scene, double fov_rad, int width, int height) {
  constexpr double kElevation_rad = 0.72;
  constexpr double kAzimuth_rad =
      -1.85;                     // from the right of a robot that looks along x, and a little behind it
  constexpr double kAir = 1.06;  // around what is framed
  const Bounds bounds = ContentBounds(scene);
  const Vector3 backward(std::cos(kElevation_rad) * std::cos(kAzimuth_rad),
                         std::cos(kElevation_rad) * std::sin(kAzimuth_rad), std::sin(kElevation_rad));
  const double tan_y = std::tan(fov_rad / 2) / kAir;
  Camera camera;
  camera.fov_rad = fov_rad;
  camera.eye_W = FitEye(bounds, CameraAxes(backward), tan_y * width / height, tan_y);
  const double distance_m = std::max((camera.eye_W - bounds.center()).dot(backward), 0.5);
  camera.look_W = camera.eye_W - distance_m * backward;
  return camera;
}

Camera CameraFor(const ImageRequest& request, const Scene& scene) {
  Camera camera = DefaultCamera(scene, request.fov_rad, request.width, request.height);
  if (request.eye_m || request.look_m) {
    const Vector3 back = camera.eye_W - camera.look_W;
    camera.look_W = request.look_m.value_or(camera.look_W);
    camera.eye_W = request.eye_m.value_or(camera.look_W + back);
    if ((camera.eye_W - camera.look_W).norm() < 1e-6)
      camera.look_W.x() += 1;  // an eye at the middle of the scene
  }
  const Bounds content = ContentBounds(scene), floor = FloorBounds(scene.floor);
  double farthest_m = 10;
  for (int i = 0; i < 8; ++i) {
    farthest_m = std::max(
        {farthest_m, (content.corner(i) - camera.eye_W).norm(), (floor.corner(i) - camera.eye_W).norm()});
  }
  camera.near_m = std::clamp(0.01 * (camera.eye_W - camera.look_W).norm(), 0.02, 1.0);
  camera.far_m = 2 * farthest_m;  // robots may have left the floor
  return camera;
}

}  // namespace coopdyn
