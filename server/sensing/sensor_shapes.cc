// SPDX-License-Identifier: MIT
#include "server/sensing/sensor_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <utility>

#include "server/base/portable_math.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

namespace {

constexpr double kMaxRay_m = 100;
constexpr std::size_t kFewRays = 32;        // a lidar with more shows only the rays' ends
constexpr std::size_t kMostPoints = 30000;  // of all lidars in a picture; beyond, shows every n-th

constexpr Rgba kHitRay{1, 0.35, 0.1, 0.75}, kHitDot{1, 0.25, 0.05, 0.95}, kFreeRay{0.1, 0.6, 0.35, 0.3};
constexpr Rgba kScanDot{0.05, 0.35, 0.95, 0.95}, kScanArea{0.15, 0.45, 1, 0.13};
constexpr Rgba kView{0.1, 0.1, 0.15, 0.8}, kViewArea{0.1, 0.1, 0.15, 0.06};

Rgba WithAlpha(Rgba color, double alpha) {
  color.a = alpha;
  return color;
}

/// Colours of a lidar's rows, from blue (lowest) through green to red (uppermost).
Rgba RowColor(int row, int rows) {
  const double part = static_cast<double>(row) / std::max(rows - 1, 1);
  const auto bump = [part](double middle) { return std::clamp(1.5 - 4 * std::abs(part - middle), 0.0, 1.0); };
  return {bump(0.85), 0.85 * bump(0.5), bump(0.15), 0.95};
}

/// About how many vertices a sensor's shapes have; a ray of a lidar takes the time of three.
std::size_t CostOf(const SensorModel& sensor) {
  constexpr std::size_t kRay = 3, kCone = 24 * 3 + 48 * 2, kPyramid = 25;
  return std::visit(
      [](const auto& kind) -> std::size_t {
        using Kind = std::remove_cvref_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, SonarModel>) return ValueCount(kind) * (kRay + kCone);
        if constexpr (std::is_same_v<Kind, CameraModel>) return kPyramid;
        if constexpr (IsKept<Kind>) return ValueCount(kind) * kRay;
        return 0;
      },
      sensor.kind);
}

/// Each so manieth robot is shown.
std::size_t RobotStride(const Scene& scene, std::size_t most) {
  std::size_t cost = 0;
  for (const SceneRobot& robot : scene.robots) {
    for (const SensorModel& sensor : robot.entry.model->sensors) cost += CostOf(sensor);
  }
  return cost / most + 1;
}

class Marker {
 public:
  Marker(const Frame& frame, const SeesBall& sees, std::size_t most)
      : frame_(frame), sees_(sees), robot_stride_(RobotStride(*frame.scene, most)) {
    std::size_t points = 0;
    for (std::size_t i = 0; i < frame.scene->robots.size(); i += robot_stride_) {
      for (const SensorModel& sensor : frame.scene->robots[i].entry.model->sensors) {
        if (const auto* lidar = std::get_if<LidarModel>(&sensor.kind)) points += lidar->rays();
      }
    }
    stride_ = points / kMostPoints + 1;
  }

  void AddRobots() {
    for (std::size_t i = 0; i < frame_.scene->robots.size(); i += robot_stride_)
      AddRobot(static_cast<int>(i));
  }

  SensorShapes Take() { return std::move(shapes_); }

 private:
  void AddRobot(int robot) {
    const RobotModel& model = ModelOf(frame_, robot);
    if (model.Find<DistanceModel>() != nullptr) AddRays(DistanceRays(frame_, robot));
    for (std::size_t i = 0; i < model.sensors.size(); ++i) {
      const Sensor sensor{SampleOf(frame_, robot, i), robot, model.NumberOf(i)};
      std::visit([&](const auto& kind) { Add(kind, sensor); }, model.sensors[i].kind);
    }
  }

  /// A sensor with the frame that it shows and its index within its kind.
  struct Sensor {
    const Frame& frame;
    int robot;
    std::size_t number;
  };

  template <typename Kind>
  void Add(const Kind& /*kind*/, const Sensor& /*sensor*/) {}

  void Add(const InfraredModel& model, const Sensor& sensor) {
    if (MaySee(sensor, model.eyes, model.max_range_m))
      AddRays(InfraredRays(sensor.frame, sensor.robot, sensor.number));
  }

  void Add(const LidarModel& model, const Sensor& sensor) {
    if (!MaySee(sensor, std::array{model.mount}, model.max_range_m)) return;
    const std::vector<RaySegment> rays = ScanRays(sensor.frame, sensor.robot, sensor.number);
    if (rays.size() <= kFewRays) return AddRays(rays);
    if (model.rows == 1) AddArea(rays);
    const double radius_px = model.rows == 1 ? 1.9 : 1.5;
    const auto columns = static_cast<std::size_t>(model.columns);
    for (std::size_t k = 0; k < rays.size(); k += stride_) {
      if (!rays[k].hit) continue;
      const Rgba color = model.rows == 1 ? kScanDot : RowColor(static_cast<int>(k / columns), model.rows);
      shapes_.dots.push_back({rays[k].to_W, color, radius_px, 3 * model.noise.stddev});
    }
  }

  void Add(const SonarModel& /*model*/, const Sensor& sensor) {
    AddRays(SonarRays(sensor.frame, sensor.robot, sensor.number));
    for (const RangeCone& cone : SonarCones(sensor.frame, sensor.robot, sensor.number)) {
      if (cone.length_m > 0 && sees_(cone.X_WS.p, cone.length_m)) AddCone(cone);
    }
  }

  /// A pyramid with a flag on its upper edge. Uses the camera's current pose, not its sample's, to avoid
  /// stutter.
  void Add(const CameraModel& model, const Sensor& sensor) {
    const RobotModel& robot = ModelOf(frame_, sensor.robot);
    const Pose X_WS = MountPose(frame_, sensor.robot, model.mount);
    const double robot_m =
        std::sqrt(robot.footprint_radius_m * robot.footprint_radius_m + robot.height_m * robot.height_m);
    const double depth_m = std::min(1.5 * robot_m, model.far_m);
    const double across_m = depth_m * model.width / 2 / model.focal_px(),
                 up_m = depth_m * model.height / 2 / model.focal_px();
    if (!sees_(X_WS.p, Vector3(depth_m, across_m, 1.6 * up_m).norm())) return;
    const auto point = [&](double left, double up) {
      return X_WS * Vector3(depth_m, left * across_m, up * up_m);
    };
    const std::array corners{point(1, 1), point(-1, 1), point(-1, -1), point(1, -1)};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      AddLine(X_WS.p, corners[i], kView);
      AddLine(corners[i], corners[(i + 1) % corners.size()], kView);
    }
    AddTriangle(corners[0], corners[1], corners[2], kViewArea);
    AddTriangle(corners[0], corners[2], corners[3], kViewArea);
    AddTriangle(point(0.3, 1.1), point(-0.3, 1.1), point(0, 1.5), kView);
  }

  template <typename Mounts>
  bool MaySee(const Sensor& sensor, const Mounts& mounts, double range_m) const {
    return std::ranges::any_of(mounts, [&](const Mount& mount) {
      return sees_(MountPose(sensor.frame, sensor.robot, mount).p, range_m);
    });
  }

  void AddRays(const std::vector<RaySegment>& rays) {
    constexpr double kWidth_px = 1.3;
    for (const RaySegment& ray : rays) {
      Vector3 to_W = ray.to_W;
      const double length_m = (to_W - ray.from_W).norm();
      if (length_m <= 0) continue;
      if (length_m > kMaxRay_m) to_W = ray.from_W + (to_W - ray.from_W) * (kMaxRay_m / length_m);
      shapes_.lines.push_back({ray.from_W, to_W, ray.hit ? kHitRay : kFreeRay, kWidth_px});
      if (ray.hit) shapes_.dots.push_back({to_W, kHitDot, 2 * kWidth_px});
    }
  }

  /// Adds the area between a lidar and the hits of its rays.
  void AddArea(const std::vector<RaySegment>& rays) {
    for (std::size_t k = stride_; k < rays.size(); k += stride_) {
      const RaySegment &one = rays[k - stride_], &other = rays[k];
      if (one.hit && other.hit) AddTriangle(one.from_W, one.to_W, other.to_W, kScanArea);
    }
  }

  void AddCone(const RangeCone& cone) {
    constexpr int kSides = 24, kArc = 6;
    const Rgba& color = cone.hit ? kHitRay : kFreeRay;
    // The point on the cap at angle `off_rad` from the axis.
    const auto on_cap = [&](double off_rad, double round_rad) {
      return cone.X_WS * (cone.length_m * Vector3(portable::Cos(off_rad),
                                                  portable::Sin(off_rad) * portable::Cos(round_rad),
                                                  portable::Sin(off_rad) * portable::Sin(round_rad)));
    };
    const auto rim = [&](int side) {
      return on_cap(cone.half_angle_rad, 2 * std::numbers::pi * side / kSides);
    };
    for (int side = 0; side < kSides; ++side) {
      AddTriangle(cone.X_WS.p, rim(side), rim(side + 1), WithAlpha(color, 0.25 * color.a));
      AddLine(rim(side), rim(side + 1), color);
    }
    for (const double round_rad : {0.0, std::numbers::pi / 2}) {
      for (int i = -kArc; i < kArc; ++i) {
        AddLine(on_cap(cone.half_angle_rad * i / kArc, round_rad),
                on_cap(cone.half_angle_rad * (i + 1) / kArc, round_rad), color);
      }
    }
  }

  void AddLine(const Vector3& from_W, const Vector3& to_W, const Rgba& color) {
    constexpr double kWidth_px = 1.1;
    shapes_.lines.push_back({from_W, to_W, color, kWidth_px});
  }

  void AddTriangle(const Vector3& a_W, const Vector3& b_W, const Vector3& c_W, const Rgba& color) {
    shapes_.triangles.push_back({{a_W, b_W, c_W}, color});
  }

  const Frame& frame_;
  const SeesBall& sees_;
  SensorShapes shapes_;
  std::size_t robot_stride_;
  std::size_t stride_ = 1;  // of the points of lidars
};

}  // namespace

SensorShapes ShapesOfSensors(const Frame& frame, const SeesBall& sees, std::size_t most) {
  Marker marker(frame, sees, most);
  marker.AddRobots();
  return marker.Take();
}

}  // namespace coopdyn
