// SPDX-License-Identifier: MIT
// The rays of a distance sensor in the robot's frame R, and a map of where they go, worked out
// once. Constant once made; any thread.
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
  Vector3 p_RO = Vector3::Zero();  // its origin
  Vector3 d_R = Vector3::UnitX();  // its direction, unit
  double limit_m = 0;              // a hit nearer than this is within the sensor's range
  std::uint32_t sector = 0;        // index into DistanceModel::sectors
};

/// Up to kMaxRays rays, cast together. Sets of them are bits.
class SensorFan {
 public:
  static constexpr std::size_t kMaxRays = 64;

  /// All rays of `model`, by sector, right to left; with maps for things of up to `thing_radius_m`.
  static std::vector<SensorFan> MakeAll(const DistanceModel& model, double thing_radius_m);

  const std::vector<FanRay>& rays() const { return rays_; }
  /// All of them.
  std::uint64_t all() const { return ~std::uint64_t{0} >> (kMaxRays - rays_.size()); }
  /// Holds all points of all rays, in R.
  const Extent& reach() const { return reach_; }

  /// Whether Near() holds for a robot that leans by `tilt`.
  static bool HasMap(const Tilt& tilt) { return tilt.sine <= kMaxTilt && tilt.cosine > 0; }
  /// The radius up to which Near() holds.
  double thing_radius_m() const { return thing_radius_m_; }
  /// From the world's plane to the map of a robot.
  struct Turn {
    double cosine = 1, sine = 0;  // in cells per metre
  };
  Turn TurnToMap(const Matrix3& R_WR) const;
  /// The rays that may meet a thing inside a vertical cylinder of up to thing_radius_m() whose axis is (dx,
  /// dy) away from R's origin in the world.
  std::uint64_t Near(const Turn& turn, double dx, double dy) const {
    // Whole cells; out of the map, the empty one in the corner. Written so that no branch has to be guessed.
    const auto column =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(dx * turn.cosine + dy * turn.sine + kHalf));
    const auto row =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(dy * turn.cosine - dx * turn.sine + kHalf));
    const auto inside =
        static_cast<std::uint64_t>(static_cast<int>(column < kCells) & static_cast<int>(row < kCells));
    return map_[(row * kCells + column) & (0 - inside)];
  }

 private:
  static constexpr std::uint64_t kCells = 64;  // along x and y: the map stays in a fast cache
  static constexpr double kHalf = kCells / 2.0;
  static constexpr double kMaxTilt = 0.02;

  SensorFan(std::vector<FanRay> rays, double thing_radius_m);
  void DrawMap();

  std::vector<FanRay> rays_;
  Extent reach_;
  double thing_radius_m_ = 0;
  double cells_per_m_ = 0;
  std::vector<std::uint64_t> map_;  // a square about R's origin; no ray gets near the cells at its edge
};

}  // namespace coopdyn
