// SPDX-License-Identifier: MIT
#include "server/devices/wheels.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

/// Beyond any limit, and still far from overflow when divided by a wheel radius.
constexpr double kHuge = 1e100;

}  // namespace

Setpoint LimitWheels(const DriveModel& drive, Setpoint wheels, double& factor) {
  const double fastest = std::max(std::abs(wheels[0]), std::abs(wheels[1]));
  if (fastest <= drive.max_wheel_speed_rad_s) return wheels;
  const double scale = drive.max_wheel_speed_rad_s / fastest;
  factor *= scale;
  for (double& wheel : wheels) {
    // Rounding must not bring it beyond the limit again.
    wheel = std::clamp(wheel * scale, -drive.max_wheel_speed_rad_s, drive.max_wheel_speed_rad_s);
  }
  return wheels;
}

Setpoint WheelsFor(const DriveModel& drive, double linear_m_s, double angular_rad_s, double& factor) {
  const double largest = std::max(std::abs(linear_m_s), std::abs(angular_rad_s));
  if (largest > kHuge) {
    factor = kHuge / largest;
    linear_m_s *= factor;
    angular_rad_s *= factor;
  }
  const double half_turn_m_s = angular_rad_s * drive.track_m / 2;
  return LimitWheels(drive,
                     {(linear_m_s - half_turn_m_s) / drive.wheel_radius_m,
                      (linear_m_s + half_turn_m_s) / drive.wheel_radius_m},
                     factor);
}

}  // namespace coopdyn
