// SPDX-License-Identifier: MIT
// Lidars: ranges along many rays from one point. The readings are costly, so the frame's cache keeps them.
#include <cmath>
#include <vector>

#include "server/base/portable_math.h"
#include "server/sensing/range_noise.h"
#include "server/sensing/ray_caster.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

/// Angle `index` of `count` evenly spread ones.
double Spread(double first, double last, int count, int index) {
  return count > 1 ? first + (last - first) * index / (count - 1) : first;
}

std::vector<Vector3> DirectionsOf(const LidarModel& model) {
  std::vector<portable::SineCosine> columns;
  for (int column = 0; column < model.columns; ++column) {
    const double azimuth_rad = Spread(model.first_azimuth_rad, model.last_azimuth_rad, model.columns, column);
    columns.push_back(portable::SinCos(azimuth_rad));
  }
  std::vector<Vector3> directions_S;
  directions_S.reserve(model.rays());
  for (int row = 0; row < model.rows; ++row) {
    const double elevation_rad = Spread(model.first_elevation_rad, model.last_elevation_rad, model.rows, row);
    const auto [up, across] = portable::SinCos(elevation_rad);
    for (const auto& [sine, cosine] : columns) directions_S.emplace_back(across * cosine, across * sine, up);
  }
  return directions_S;
}

}  // namespace

void Compute(const LidarModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> ranges_m) {
  const Frame& frame = cache.frame();
  const Pose X_WS = MountPose(frame, robot, model.mount);
  const Matrix3 R_WS = X_WS.q.toRotationMatrix();
  const RayCaster caster(cache, robot, model.mount.link);
  NoiseKey key = KeyOf(frame, robot, NoiseKind::kLidar, sensor.number);
  const ValueNoise noise = WithBias(model.noise, key);
  const std::vector<Vector3> directions_S = DirectionsOf(model);
  for (std::size_t k = 0; k < ranges_m.size(); ++k) {
    key.sample = static_cast<std::uint32_t>(k);
    const double range_m = caster.Cast({X_WS.p, R_WS * directions_S[k]}, model.max_range_m);
    ranges_m[k] = NoisyRange(range_m, model.min_range_m, model.max_range_m, noise, key);
  }
}

std::span<const double> Scan(const Frame& frame, int robot, std::size_t number) {
  return SensingCache::Of(frame).ValuesOf<LidarModel>(robot, number);
}

std::vector<RaySegment> ScanRays(const Frame& frame, int robot, std::size_t number) {
  const auto* const model = ModelOf(frame, robot).Find<LidarModel>(number);
  if (model == nullptr) return {};
  const Pose X_WS = MountPose(frame, robot, model->mount);
  const Matrix3 R_WS = X_WS.q.toRotationMatrix();
  const std::vector<Vector3> directions_S = DirectionsOf(*model);
  const std::span<const double> ranges_m = Scan(frame, robot, number);
  std::vector<RaySegment> segments;
  segments.reserve(ranges_m.size());
  for (std::size_t k = 0; k < ranges_m.size(); ++k) {
    const bool far = ranges_m[k] == kNoHit;
    const double length_m = far ? model->max_range_m : ranges_m[k];
    segments.push_back({X_WS.p, X_WS.p + length_m * (R_WS * directions_S[k]), !far && length_m > 0});
  }
  return segments;
}

}  // namespace coopdyn
