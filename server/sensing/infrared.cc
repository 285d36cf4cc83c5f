// SPDX-License-Identifier: MIT
// Infrared range finders: the output of their curve at the distance of the nearest thing in the beam.
#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"
#include "server/sensing/range_noise.h"
#include "server/sensing/ray_caster.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

Ray RayOf(const InfraredModel& model, const Pose& X_WS, int index) {
  const double angle_rad = BeamAngle(model.opening_rad, model.rays, index);
  const auto [sine, cosine] = portable::SinCos(angle_rad);
  return {X_WS.p, X_WS.q * Vector3(cosine, sine, 0)};
}

}  // namespace

InfraredModel::Row OnCurve(std::span<const InfraredModel::Row> curve, double distance_m) {
  const auto above = std::ranges::find_if(
      curve, [distance_m](const InfraredModel::Row& row) { return row.distance_m > distance_m; });
  if (above == curve.begin()) return curve.front();
  if (above == curve.end()) return curve.back();
  const InfraredModel::Row &one = *(above - 1), &other = *above;
  const double part = (distance_m - one.distance_m) / (other.distance_m - one.distance_m);
  return {distance_m, std::lerp(one.value, other.value, part),
          std::lerp(one.noise_stddev, other.noise_stddev, part)};
}

void Compute(const InfraredModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> values) {
  const Frame& frame = cache.frame();
  NoiseKey key = KeyOf(frame, robot, NoiseKind::kInfrared, sensor.number);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Mount& eye = model.eyes[k];
    const Pose X_WS = MountPose(frame, robot, eye);
    const RayCaster caster(cache, robot, eye.link);
    double nearest_m = kNoHit;
    for (int i = 0; i < model.rays; ++i) {
      nearest_m =
          std::min(nearest_m, caster.Cast(RayOf(model, X_WS, i), std::min(nearest_m, model.max_range_m)));
    }
    key.sample = static_cast<std::uint32_t>(k);
    ValueNoise noise = model.noise;
    if (nearest_m == kNoHit || model.curve.empty()) {
      values[k] = Noisy(model.dark, noise, key);
      continue;
    }
    const InfraredModel::Row row = OnCurve(model.curve, nearest_m);
    noise.stddev = portable::Hypot(noise.stddev, row.noise_stddev);
    values[k] = Noisy(row.value, noise, key);
  }
}

std::span<const double> InfraredValues(const Frame& frame, int robot, std::size_t number) {
  return SensingCache::Of(frame).ValuesOf<InfraredModel>(robot, number);
}

std::vector<RaySegment> InfraredRays(const Frame& frame, int robot, std::size_t number) {
  const auto* const model = ModelOf(frame, robot).Find<InfraredModel>(number);
  if (model == nullptr) return {};
  std::vector<RaySegment> segments;
  for (const Mount& eye : model->eyes) {
    const Pose X_WS = MountPose(frame, robot, eye);
    const RayCaster caster(SensingCache::Of(frame), robot, eye.link);
    for (int i = 0; i < model->rays; ++i)
      segments.push_back(caster.Segment(RayOf(*model, X_WS, i), model->max_range_m));
  }
  return segments;
}

}  // namespace coopdyn
