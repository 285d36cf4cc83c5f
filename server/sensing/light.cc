// SPDX-License-Identifier: MIT
// Light sensors: the lamps that they see, and the light all round. docs/physics.md has the formula.
#include <algorithm>
#include <cmath>

#include "server/sensing/range_noise.h"
#include "server/sensing/ray_caster.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

constexpr double kNearest_m = 0.01;  // a lamp is no brighter than from here

/// What an eye that looks along x reads of a lamp at p_SP, in the eye's frame, if nothing hides it.
double Shine(const PointLight& light, const LightModel::Eye& eye, const Vector3& p_SP) {
  const double brightness = (light.color.r + light.color.g + light.color.b) / 3;
  const double d_m = std::max(p_SP.norm(), kNearest_m);
  const double power = light.power * brightness / (d_m * d_m);
  if (eye.opening_rad <= 0) return power;
  const double angle_rad = std::atan2(std::hypot(p_SP.y(), p_SP.z()), p_SP.x());
  return power * std::max(0.0, 1 - 2 * angle_rad / eye.opening_rad);
}

}  // namespace

std::vector<double> LightValues(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<LightModel>(number);
  if (model == nullptr) return {};
  const SensingCache& cache = SensingCache::Of(frame);
  const Scene& scene = *frame.scene;
  NoiseKey key = KeyOf(frame, robot, NoiseKind::kLight, number);
  std::vector<double> values;
  for (const LightModel::Eye& eye : model->eyes) {
    const Pose X_WS = MountPose(frame, robot, eye.mount);
    const RayCaster caster(cache, robot, eye.mount.link);
    double sum = scene.ambient_light;
    for (const PointLight& light : scene.lights) {
      const Vector3 p_SP_W = light.p_WP - X_WS.p;
      const double shine = Shine(light, eye, X_WS.q.conjugate() * p_SP_W);
      if (shine <= 0) continue;
      const double d_m = p_SP_W.norm();
      const bool hidden = light.casts_shadows && d_m > 0 && caster.Cast({X_WS.p, p_SP_W / d_m}, d_m) < d_m;
      if (!hidden) sum += shine;
    }
    key.sample = static_cast<std::uint32_t>(values.size());
    values.push_back(model->noise.exact() ? sum : std::max(0.0, Noisy(sum, model->noise, key)));
  }
  return values;
}

}  // namespace coopdyn
