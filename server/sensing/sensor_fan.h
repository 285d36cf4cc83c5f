// SPDX-License-Identifier: MIT
// The rays of a robot type's distance sensors in the robot's frame R, worked out once. Constant once made;
// any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/model/robot_model.h"
#include "server/sensing/extent.h"

namespace coopdyn {

/// One ray of a distance sensor.
struct FanRay {
  Vector3 p_RO = Vector3::Zero();  // its origin
  Vector3 d_R = Vector3::UnitX();  // its direction, unit
  double limit_m = 0;              // a hit nearer than this is within the sensor's range
  std::uint32_t sensor = 0;        // index into RobotModel::distance_sensors
  std::uint32_t index = 0;         // among all rays of the model, by sensor, right to left
};

/// How a robot's frame R stands, as far as bearings go.
struct FanPlace {
  double cos_yaw = 1, sin_yaw = 0;  // of R's x axis in the plane
  Tilt tilt;

  FanPlace() = default;
  FanPlace(const Matrix3& R_WR, const Tilt& lean);
};

/// Up to kMaxRays rays, cast together; by increasing bearing in R.
class SensorFan {
 public:
  static constexpr std::size_t kMaxRays = 64;

  /// All rays of `model`.
  static std::vector<SensorFan> MakeAll(const RobotModel& model);

  const std::vector<FanRay>& rays() const { return rays_; }
  /// Holds all points of all rays, in R.
  const Extent& reach() const { return reach_; }

  /// A part of the sequence of all rays followed by all rays again.
  struct Part {
    std::uint32_t first = 0, end = 0;
  };
  /// Holds every ray that can meet a vertical cylinder of radius `radius_m` whose axis is (dx, dy) away from
  /// R's origin in the world's plane; each ray at most once.
  Part Toward(const FanPlace& place, double dx, double dy, double radius_m) const;

 private:
  static constexpr int kBins = 128;  // of bearings
  static constexpr double kMaxTilt = 0.05;

  explicit SensorFan(std::vector<FanRay> rays);
  void MakeBearings();

  std::vector<FanRay> rays_;
  Extent reach_;
  // What tells the rays of a bearing.
  bool has_bearings_ = false;        // no ray is steep
  double miss_m_ = 0;                // a ray's line passes R's z axis, and starts beyond it, within this
  double origin_m_ = 0;              // largest distance of a ray's origin from R's origin
  std::vector<float> bearings_rad_;  // of the rays, then one turn on of all again, then infinity
  std::array<std::uint16_t, kBins + 1> first_{};  // in bearings_rad_: the first in or after each bin
};

/// The bearing of (x, y) in [−π, π], wrong by less than kRoughBearing_rad.
float RoughBearing(float y, float x);
inline constexpr float kRoughBearing_rad = 1e-3F;

}  // namespace coopdyn
