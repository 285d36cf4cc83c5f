// SPDX-License-Identifier: MIT
#include "server/model/sensor_models.h"

#include <cmath>

namespace coopdyn {

namespace {

std::size_t Count(const auto& /*kind*/) {
  return 0;
}
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
/// x, y, heading, forward speed, turn rate; then the ways of the left and the right wheel that count, rad: 7.
std::size_t Count(const OdometryModel& /*kind*/) {
  return 7;
}

}  // namespace

std::size_t MeasuredCount(const SensorKind& kind) {
  return std::visit([](const auto& one) { return Count(one); }, kind);
}

double CameraModel::focal_px() const {
  return width / (2 * std::tan(horizontal_fov_rad / 2));
}

}  // namespace coopdyn
