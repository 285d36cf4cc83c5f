// SPDX-License-Identifier: MIT
// How far the things fixed to a robot extend from it, at any tilt. Pure; any thread.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/geometry/ray.h"

namespace coopdyn {

/// A frame's tilt: the angle between its z axis and the vertical.
struct Tilt {
  double sine = 0, cosine = 1;

  Tilt() = default;
  explicit Tilt(const Quaternion& q) {
    const double across = q.x() * q.x() + q.y() * q.y();
    cosine = 1 - 2 * across;
    sine = 2 * std::sqrt(across * (q.w() * q.w() + q.z() * q.z()));
  }
};

/// A cylinder about the z axis of a frame.
struct Extent {
  double radius_m = 0, min_z = kNoHit, max_z = -kNoHit;

  bool empty() const { return min_z > max_z; }

  void Include(double radius, double low, double high) {
    radius_m = std::max(radius_m, radius);
    min_z = std::min(min_z, low);
    max_z = std::max(max_z, high);
  }

  /// The upright cylinder about the vertical through the frame's origin that contains this one when the frame
  /// is at height `z` with tilt `tilt`. @pre not empty.
  Extent Upright(double z, const Tilt& tilt) const {
    const double high = max_z * tilt.cosine, low = min_z * tilt.cosine;
    return {radius_m + tilt.sine * std::max(std::abs(min_z), std::abs(max_z)) + kPad_m,
            z + std::min(low, high) - tilt.sine * radius_m - kPad_m,
            z + std::max(low, high) + tilt.sine * radius_m + kPad_m};
  }

  /// Margin of bounds: rounding must not lose a hit.
  static constexpr double kPad_m = 1e-6;
};

}  // namespace coopdyn
