// SPDX-License-Identifier: MIT
#include "server/model/sensor_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

std::size_t Count(const auto& /*kind*/) {
  return 0;
}
// Number of measured values of each kind.

/// Acceleration of the sensor's origin without gravity, in S: 3.
std::size_t Count(const ImuModel& /*kind*/) {
  return 3;
}
/// Force and torque in S: 6.
std::size_t Count(const WrenchModel& /*kind*/) {
  return 6;
}
/// Energy J and power W: 2.
std::size_t Count(const BatteryModel& /*kind*/) {
  return 2;
}
/// x, y, heading, forward speed, turn rate; then the counted travel of the left and the right wheel, rad: 7.
std::size_t Count(const OdometryModel& /*kind*/) {
  return 7;
}
/// The energies, angles and filter states of its values.
std::size_t Count(const ChannelModel& model) {
  return model.cells();
}

// Length of a reading of each kind; 0 if it varies.

std::size_t ReadingCount(const DistanceModel& model) {
  return model.sectors.size();
}
std::size_t ReadingCount(const PoseModel& /*model*/) {
  return 5;
}
std::size_t ReadingCount(const CompassModel& /*model*/) {
  return 1;
}
std::size_t ReadingCount(const SupportModel& /*model*/) {
  return 3;
}
std::size_t ReadingCount(const ImuModel& /*model*/) {
  return 10;
}
std::size_t ReadingCount(const WrenchModel& /*model*/) {
  return 6;
}
std::size_t ReadingCount(const LidarModel& model) {
  return model.rays();
}
std::size_t ReadingCount(const ContactModel& model) {
  return std::max<std::size_t>(model.zones.size(), 1);
}
std::size_t ReadingCount(const SonarModel& model) {
  return model.beams.size();
}
std::size_t ReadingCount(const InfraredModel& model) {
  return model.eyes.size();
}
std::size_t ReadingCount(const LightModel& model) {
  return model.eyes.size();
}
std::size_t ReadingCount(const BatteryModel& /*model*/) {
  return 3;
}
std::size_t ReadingCount(const OdometryModel& /*model*/) {
  return 5;
}
std::size_t ReadingCount(const ChannelModel& model) {
  return model.values.size();
}
template <typename Kind>
std::size_t ReadingCount(const Kind& /*model*/) {
  return 0;
}

}  // namespace

std::size_t FixedCount(const SensorKind& kind) {
  return std::visit([](const auto& one) { return ReadingCount(one); }, kind);
}

std::size_t MeasuredCount(const SensorKind& kind) {
  return std::visit([](const auto& one) { return Count(one); }, kind);
}

Vector3 SonarModel::Beam::Direction(int index) const {
  if (index == 0 || rays < 2) return Vector3::UnitX();
  const double round_rad = 2 * std::numbers::pi * (index - 1) / (rays - 1);
  const double left_rad = opening_rad / 2 * portable::Cos(round_rad),
               up_rad = opening_up_rad / 2 * portable::Sin(round_rad);
  const double angle_rad = portable::Hypot(left_rad, up_rad);
  if (angle_rad <= 0) return Vector3::UnitX();
  const double part = portable::Sin(angle_rad) / angle_rad;
  return {portable::Cos(angle_rad), part * left_rad, part * up_rad};
}

double CameraModel::focal_px() const {
  return width / (2 * portable::Tan(horizontal_fov_rad / 2));
}

}  // namespace coopdyn
