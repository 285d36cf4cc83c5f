// SPDX-License-Identifier: MIT
#include "server/sensing/sensor_fan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "server/geometry/ray.h"

namespace coopdyn {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr double kSteep = 0.5;  // least horizontal part of a direction whose bearing means anything

}  // namespace

FanPlace::FanPlace(const Matrix3& R_WR, const Tilt& lean) : tilt(lean) {
  const double length = std::sqrt(R_WR(0, 0) * R_WR(0, 0) + R_WR(1, 0) * R_WR(1, 0));
  if (length > 0) {
    cos_yaw = R_WR(0, 0) / length;
    sin_yaw = R_WR(1, 0) / length;
  }
}

float RoughBearing(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float large = std::max(ax, ay), small = std::min(ax, ay);
  const float a = large > 0 ? small / large : 0;
  const float s = a * a;
  float angle = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  angle = ay > ax ? kPi / 2 - angle : angle;
  angle = x < 0 ? kPi - angle : angle;
  return std::copysign(angle, y);
}

std::vector<SensorFan> SensorFan::MakeAll(const RobotModel& model) {
  std::vector<FanRay> rays;
  for (std::size_t k = 0; k < model.distance_sensors.size(); ++k) {
    const DistanceSensorModel& sensor = model.distance_sensors[k];
    for (int i = 0; i < sensor.rays; ++i) {
      // Spread evenly from the right edge of the sector to its left one.
      const double angle_rad =
          sensor.rays > 1 ? sensor.opening_rad * (static_cast<double>(i) / (sensor.rays - 1) - 0.5) : 0;
      rays.push_back({sensor.X_RS.p, sensor.X_RS.q * Vector3(std::cos(angle_rad), std::sin(angle_rad), 0),
                      std::nextafter(sensor.max_range_m, kNoHit), static_cast<std::uint32_t>(k),
                      static_cast<std::uint32_t>(rays.size())});
    }
  }
  const auto bearing = [](const FanRay& ray) { return std::atan2(ray.d_R.y(), ray.d_R.x()); };
  std::stable_sort(rays.begin(), rays.end(),
                   [&](const FanRay& a, const FanRay& b) { return bearing(a) < bearing(b); });
  std::vector<SensorFan> fans;
  for (std::size_t first = 0; first < rays.size(); first += kMaxRays) {
    const std::size_t end = std::min(rays.size(), first + kMaxRays);
    fans.push_back(SensorFan({rays.begin() + static_cast<std::ptrdiff_t>(first),
                              rays.begin() + static_cast<std::ptrdiff_t>(end)}));
  }
  return fans;
}

SensorFan::SensorFan(std::vector<FanRay> rays) : rays_(std::move(rays)) {
  for (const FanRay& ray : rays_) {
    const Vector3 end = ray.p_RO + ray.limit_m * ray.d_R;
    for (const Vector3& p : {ray.p_RO, end}) reach_.Include(std::hypot(p.x(), p.y()), p.z(), p.z());
  }
  MakeBearings();
}

void SensorFan::MakeBearings() {
  has_bearings_ = true;
  for (const FanRay& ray : rays_) {
    const double length = std::hypot(ray.d_R.x(), ray.d_R.y());
    if (length < kSteep) {
      has_bearings_ = false;
      return;
    }
    const double ux = ray.d_R.x() / length, uy = ray.d_R.y() / length;
    const double across = std::abs(ux * ray.p_RO.y() - uy * ray.p_RO.x());
    const double behind = -(ux * ray.p_RO.x() + uy * ray.p_RO.y());
    miss_m_ = std::max(miss_m_, across + std::max(behind, 0.0));
    origin_m_ = std::max(origin_m_, ray.p_RO.norm());
    bearings_rad_.push_back(static_cast<float>(std::atan2(uy, ux)));
  }
  const std::size_t count = bearings_rad_.size();
  for (std::size_t i = 0; i < count; ++i) bearings_rad_.push_back(bearings_rad_[i] + 2 * kPi);
  bearings_rad_.push_back(std::numeric_limits<float>::infinity());
  for (int bin = 0; bin <= kBins; ++bin) {
    const float from = -kPi + 2 * kPi * static_cast<float>(bin) / kBins - kRoughBearing_rad;
    const auto found = std::lower_bound(bearings_rad_.begin(), bearings_rad_.end(), from);
    first_[static_cast<std::size_t>(bin)] = static_cast<std::uint16_t>(found - bearings_rad_.begin());
  }
}

SensorFan::Part SensorFan::Toward(const FanPlace& place, double dx, double dy, double radius_m) const {
  const auto count = static_cast<std::uint32_t>(rays_.size());
  if (!has_bearings_ || place.tilt.sine > kMaxTilt || place.tilt.cosine < 0) return {0, count};
  // A ray that meets the cylinder points, seen from R's z axis, at most asin(across / distance) past its
  // axis: its line passes the cylinder's axis within radius_m and R's within miss_m_. Tilting moves its
  // origin by its sine * origin_m_ or so, and turns it by less than 3 times that sine.
  const double across = radius_m + miss_m_ + 4 * place.tilt.sine * origin_m_;
  const double distance2 = dx * dx + dy * dy;
  if (distance2 <= 2 * across * across) return {0, count};  // it may even be met backwards
  const auto sine = static_cast<float>(across / std::sqrt(distance2));
  // asin(s) ≤ s + (π/2 − 1) s³
  const float half_rad =
      sine + 0.5708F * sine * sine * sine + 3 * static_cast<float>(place.tilt.sine) + 2 * kRoughBearing_rad;
  const float bearing_rad = RoughBearing(static_cast<float>(dy * place.cos_yaw - dx * place.sin_yaw),
                                         static_cast<float>(dx * place.cos_yaw + dy * place.sin_yaw));
  float low = bearing_rad - half_rad;
  low = low < -kPi ? low + 2 * kPi : low;
  const float high = low + 2 * half_rad;
  const int bin = std::clamp(static_cast<int>((low + kPi) * (kBins / (2 * kPi))), 0, kBins - 1);
  std::uint32_t first = first_[static_cast<std::size_t>(bin)];
  while (bearings_rad_[first] < low) ++first;
  std::uint32_t end = first;
  while (bearings_rad_[end] <= high) ++end;
  return {first, end};
}

}  // namespace coopdyn
