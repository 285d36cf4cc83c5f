// SPDX-License-Identifier: MIT
// Helpers shared by sensors that cast rays. Pure; any thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "server/geometry/ray.h"
#include "server/state/frame.h"
#include "server/state/noise.h"

namespace coopdyn {

/// The noise key for the first value of the robot's sensor `number` of a kind.
inline NoiseKey KeyOf(const Frame& frame, int robot, NoiseKind kind, std::size_t number) {
  return {frame.seed,
          kind,
          frame.scene->robots[static_cast<std::size_t>(robot)].id.value,
          static_cast<std::uint32_t>(number + 1),
          frame.step,
          0};
}

/// `noise` with one bias for all values of the sensor.
inline ValueNoise WithBias(ValueNoise noise, NoiseKey key) {
  if (noise.bias_stddev <= 0) return noise;
  key.step = kBiasStep;
  noise.bias_mean += noise.bias_stddev * GaussianNoise(key);
  noise.bias_stddev = 0;
  return noise;
}

/// `range_m` as read by a sensor with range `min_m` to `max_m`: 0 if nearer, kNoHit if further. Noise never
/// exceeds these limits.
inline double NoisyRange(double range_m, double min_m, double max_m, const ValueNoise& noise,
                         const NoiseKey& key) {
  if (range_m > max_m) return kNoHit;
  if (range_m < min_m) return 0;
  return noise.exact() ? range_m : std::clamp(Noisy(range_m, noise, key), min_m, max_m);
}

/// Angle `index` of `count`, evenly spread over `opening_rad` from right to left; 0 for a single one.
inline double BeamAngle(double opening_rad, int count, int index) {
  return count > 1 ? opening_rad * (static_cast<double>(index) / (count - 1) - 0.5) : 0;
}

/// The interpolated row of an infrared range finder's curve.
InfraredModel::Row OnCurve(std::span<const InfraredModel::Row> curve, double distance_m);

}  // namespace coopdyn
