// SPDX-License-Identifier: MIT
// Light sensors: visible lamps and ambient light. docs/physics.md has the formula.
#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"
#include "server/sensing/range_noise.h"
#include "server/sensing/ray_caster.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

constexpr double kNearest_m = 0.01;  // nearer lamps do not get brighter

/// The light that an eye receives.
class EyeLight {
 public:
  EyeLight(const Frame& frame, int robot, const LightModel::Eye& eye)
      : scene_(*frame.scene),
        eye_(eye),
        X_WS_(MountPose(frame, robot, eye.mount)),
        caster_(SensingCache::Of(frame), robot, eye.mount.link) {}

  double Sum() const {
    double sum = scene_.ambient_light;
    if (!eye_.sees_lamps) return sum;
    for (const PointLight& light : scene_.lights) {
      const double brightness = (light.color.r + light.color.g + light.color.b) / 3;
      sum += brightness * Power(light, std::max(0.0, AngleFactor(light)));
    }
    return sum;
  }
  /// Each colour counts up to the eye's value in `most`; full colour reads 1.
  double Saturated(const Vector3& most) const {
    Vector3 sum = Vector3::Zero();
    for (const PointLight& light : scene_.lights)
      sum +=
          Power(light, AngleFactor(light) > 0 ? 1 : 0) * Vector3(light.color.r, light.color.g, light.color.b);
    return sum.cwiseMin(most).sum() / most.sum();
  }

 private:
  /// 1 on the eye's axis, 0 at the edge of its cone.
  double AngleFactor(const PointLight& light) const {
    if (eye_.opening_rad <= 0) return 1;
    const Vector3 p_SP = X_WS_.q.conjugate() * (light.p_WP - X_WS_.p);
    const double angle_rad = portable::Atan2(portable::Hypot(p_SP.y(), p_SP.z()), p_SP.x());
    return 1 - 2 * angle_rad / eye_.opening_rad;
  }
  /// Falls with the square of the distance; 0 if something hides the lamp.
  double Power(const PointLight& light, double factor) const {
    if (factor <= 0 || light.power <= 0) return 0;
    const Vector3 p_SP_W = light.p_WP - X_WS_.p;
    const double d_m = p_SP_W.norm();
    if (light.casts_shadows && d_m > 0 && caster_.Cast({X_WS_.p, p_SP_W / d_m}, d_m) < d_m) return 0;
    const double at_m = std::max(d_m, kNearest_m);
    return light.power * factor / (at_m * at_m);
  }

  const Scene& scene_;
  const LightModel::Eye& eye_;
  const Pose X_WS_;
  const RayCaster caster_;
};

}  // namespace

std::vector<double> LightValues(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<LightModel>(number);
  if (model == nullptr) return {};
  NoiseKey key = KeyOf(frame, robot, NoiseKind::kLight, number);
  std::vector<double> values;
  for (const LightModel::Eye& eye : model->eyes) {
    const EyeLight light(frame, robot, eye);
    const double sum = eye.color ? light.Saturated(*eye.color) : light.Sum();
    key.sample = static_cast<std::uint32_t>(values.size());
    values.push_back(model->noise.exact() ? sum : std::max(0.0, Noisy(sum, model->noise, key)));
  }
  return values;
}

}  // namespace coopdyn
