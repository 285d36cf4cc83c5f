// SPDX-License-Identifier: MIT
// The rays of a distance sensor in the robot's frame R, with a precomputed map of the cells that they pass.
// Constant once made; any thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/model/robot_model.h"
#include "server/sensing/extent.h"

namespace coopdyn {

/// One ray of a distance sensor.
struct FanRay {
  Vector3 p_RO = Vector3::Zero();  // origin
  Vector3 d_R = Vector3::UnitX();  // unit direction
  double limit_m = 0;              // hits nearer than this are within the sensor's range
  std::uint32_t sector = 0;        // index into DistanceModel::sectors
};

/// Up to kMaxRays rays, cast together. Bit sets denote sets of rays.
class SensorFan {
 public:
  static constexpr std::size_t kMaxRays = 64;

  /// All rays of `model`, by sector, right to left, with maps for things of radius up to `thing_radius_m`.
  static std::vector<SensorFan> MakeAll(const DistanceModel& model, double thing_radius_m);

  const std::vector<FanRay>& rays() const { return rays_; }
  /// The set of all rays.
  std::uint64_t all() const { return ~std::uint64_t{0} >> (kMaxRays - rays_.size()); }
  /// Contains all points of all rays, in R.
  const Extent& reach() const { return reach_; }

  /// Whether Near() is valid for a robot with tilt `tilt`.
  static bool HasMap(const Tilt& tilt) { return tilt.sine <= kMaxTilt && tilt.cosine > 0; }
  /// The largest thing radius for which Near() is valid.
  double thing_radius_m() const { return thing_radius_m_; }
  /// The rotation and scale from the world's plane to the robot's map.
  struct Turn {
    double cosine = 1, sine = 0;  // in cells per metre
  };
  Turn TurnToMap(const Matrix3& R_WR) const;
  /// The rays that may hit a thing inside a vertical cylinder of radius up to thing_radius_m() whose axis is
  /// at (dx, dy) from R's origin in the world.
  std::uint64_t Near(const Turn& turn, double dx, double dy) const {
    // Cell indices; positions off the map use the empty corner cell. Branch-free.
    const auto column =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(dx * turn.cosine + dy * turn.sine + kHalf));
    const auto row =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(dy * turn.cosine - dx * turn.sine + kHalf));
    const auto inside =
        static_cast<std::uint64_t>(static_cast<int>(column < kCells) & static_cast<int>(row < kCells));
    return map_[(row * kCells + column) & (0 - inside)];
  }

 private:
  static constexpr std::uint64_t kCells = 64;  // along x and y: the map fits into a fast cache
  static constexpr double kHalf = kCells / 2.0;
  static constexpr double kMaxTilt = 0.02;

  SensorFan(std::vector<FanRay> rays, double thing_radius_m);
  void DrawMap();

  std::vector<FanRay> rays_;
  Extent reach_;
  double thing_radius_m_ = 0;
  double cells_per_m_ = 0;
  std::vector<std::uint64_t> map_;  // a square about R's origin; its border cells are empty
};

}  // namespace coopdyn
