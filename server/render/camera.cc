// SPDX-License-Identifier: MIT
#include "server/render/camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

// Corners of the visible contents.
using Points = std::vector<Vector3>;

void AddBox(const Vector3& center, const Vector3& half, Points& points) {
  for (int i = 0; i < 8; ++i) {
    points.push_back(center + Vector3(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                                      i & 4 ? half.z() : -half.z()));
  }
}

Points FloorPoints(const Floor& floor) {
  Points points;
  AddBox(Vector3::Zero(), {floor.length_m / 2, floor.width_m / 2, 0}, points);
  return points;
}

Points ContentPoints(const Scene& scene) {
  constexpr double kMargin_m = 0.5;
  Points points;
  for (const SceneObject& object : scene.objects) {
    AddBox(object.object.X_WO.p, HalfExtents(object.object.shape, object.object.X_WO.q), points);
  }
  for (const SceneRobot& robot : scene.robots) {
    const double r = robot.entry.model->footprint_radius_m + kMargin_m, h = robot.entry.model->height_m / 2;
    AddBox(robot.entry.X_WR.p + Vector3(0, 0, h), {r, r, h}, points);
  }
  for (const Target& target : scene.targets) AddBox(target.p_WT, {kMargin_m, kMargin_m, 0}, points);
  return points.empty() ? FloorPoints(scene.floor) : points;
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

// The eye of a camera that looks along −axes.row(2) such that `points` exactly fill the picture.
Vector3 FitEye(const Points& points, const Matrix3& axes, double tan_x, double tan_y) {
  // In top view and in side view, the eye is the apex of a wedge that touches points on both sides. Use the
  // farther apex.
  constexpr double kFar = 1e30;
  const double tans[2] = {tan_x, tan_y};
  double highest[2] = {-kFar, -kFar}, lowest[2] = {-kFar, -kFar};
  for (const Vector3& point : points) {
    const Vector3 p = axes * point;
    for (int axis = 0; axis < 2; ++axis) {
      highest[axis] = std::max(highest[axis], p[axis] + tans[axis] * p.z());
      lowest[axis] = std::max(lowest[axis], -p[axis] + tans[axis] * p.z());
    }
  }
  const auto back = [&](int axis) { return (highest[axis] + lowest[axis]) / (2 * tans[axis]); };
  const double distance = std::max(back(0), back(1));
  double across[2];
  for (int axis = 0; axis < 2; ++axis) {
    // On the axis with spare room, centre the points as they appear from the eye.
    double& eye = across[axis];
    eye = (highest[axis] - lowest[axis]) / 2;
    for (int i = 0; i < 8; ++i) {
      double above = -kFar, below = -kFar, depth = 0;
      for (const Vector3& point : points) {
        const Vector3 p = axes * point;
        depth = std::max(distance - p.z(), 1e-3);
        above = std::max(above, (p[axis] - eye) / depth);
        below = std::max(below, (eye - p[axis]) / depth);
      }
      eye += (above - below) / 2 * depth;
    }
  }
  return axes.transpose() * Vector3(across[0], across[1], distance);
}

/// The unit vector from what is seen towards the camera. The page has the same: server/web/page/framing.js.
Vector3 Backward(View::From from) {
  constexpr double kElevation_rad = 0.72, kAzimuth_rad = -1.85;
  switch (from) {
    case View::From::kTop:
      return Vector3(0, -0.001, 1).normalized();
    case View::From::kFront:
      return Vector3(1, 0, 0.22).normalized();
    case View::From::kSide:
      return Vector3(0, -1, 0.22).normalized();
    case View::From::kWhole:
      break;
  }
  return {std::cos(kElevation_rad) * std::cos(kAzimuth_rad),
          std::cos(kElevation_rad) * std::sin(kAzimuth_rad), std::sin(kElevation_rad)};
}

}  // namespace

Matrix4 ViewMatrix(const Camera& camera) {
  const Matrix3 axes = camera.axes ? *camera.axes : CameraAxes(camera.eye_W - camera.look_W);
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

Frustum::Frustum(const Camera& camera, int width, int height)
    : clip_from_W_(ProjectionMatrix(camera, width, height) * ViewMatrix(camera)),
      eye_W_(camera.eye_W),
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

Camera DefaultCamera(const Scene& scene, double fov_rad, int width, int height) {
  constexpr double kAir = 1.06;  // margin around the contents
  const View view = scene.scenario != nullptr ? scene.scenario->view : View();
  if (view.look_W) {
    Camera camera;
    camera.fov_rad = fov_rad;
    camera.eye_W = view.eye_W;
    camera.look_W = *view.look_W;
    return camera;
  }
  const Points points = ContentPoints(scene);
  const Vector3 backward = Backward(view.from);
  const double tan_y = std::tan(fov_rad / 2) / kAir;
  Camera camera;
  camera.fov_rad = fov_rad;
  camera.eye_W = FitEye(points, CameraAxes(backward), tan_y * width / height, tan_y);
  double nearest_m = 1e30, farthest_m = -1e30;
  for (const Vector3& point : points) {
    nearest_m = std::min(nearest_m, (camera.eye_W - point).dot(backward));
    farthest_m = std::max(farthest_m, (camera.eye_W - point).dot(backward));
  }
  const double distance_m = std::max((nearest_m + farthest_m) / 2, 0.5);
  camera.look_W = camera.eye_W - distance_m * backward;
  return camera;
}

Camera CameraOf(const Frame& frame, int robot, std::size_t sensor) {
  const RobotModel& of = ModelOf(frame, robot);
  const auto& model = std::get<CameraModel>(of.sensors[sensor].kind);
  const Pose X_WS = MountPose(frame, robot, model.mount);
  const Matrix3 R_WS = X_WS.q.normalized().toRotationMatrix();
  Camera camera;
  camera.eye_W = X_WS.p;
  camera.look_W = X_WS.p + R_WS.col(0);
  Matrix3 axes;
  axes << -R_WS.col(1).transpose(), R_WS.col(2).transpose(), -R_WS.col(0).transpose();
  camera.axes = axes;
  camera.fov_rad = 2 * std::atan(model.height / (2 * model.focal_px()));
  camera.near_m = model.near_m;
  camera.far_m = model.far_m;
  return camera;
}

Camera CameraFor(const ImageRequest& request, const Scene& scene) {
  Camera camera = DefaultCamera(scene, request.fov_rad, request.width, request.height);
  if (request.eye_m || request.look_m) {
    const Vector3 back = camera.eye_W - camera.look_W;
    camera.look_W = request.look_m.value_or(camera.look_W);
    camera.eye_W = request.eye_m.value_or(camera.look_W + back);
    if ((camera.eye_W - camera.look_W).norm() < 1e-6)
      camera.look_W.x() += 1;  // if the eye is at the look-at point
  }
  double farthest_m = 10;
  for (const Points& points : {ContentPoints(scene), FloorPoints(scene.floor)}) {
    for (const Vector3& point : points) farthest_m = std::max(farthest_m, (point - camera.eye_W).norm());
  }
  camera.near_m = std::clamp(0.01 * (camera.eye_W - camera.look_W).norm(), 0.02, 1.0);
  camera.far_m = 2 * farthest_m;  // robots may have left the floor
  return camera;
}

}  // namespace coopdyn
