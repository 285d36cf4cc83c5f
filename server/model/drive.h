// SPDX-License-Identifier: MIT
// Computes wheel speeds from the commands of a drive, within the drive's limits. Pure; any thread.
//
//   left  = (linear − angular · track / 2) / wheel radius        rad/s
//   right = (linear + angular · track / 2) / wheel radius        rad/s
//
// linear in m/s forward, angular in rad/s, left positive. If a wheel would exceed its limit, both speeds are
// scaled by the same factor, which preserves the curvature.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "server/base/portable_math.h"
#include "server/model/robot_model.h"

namespace coopdyn {

/// Left, right, rad/s.
using WheelSpeeds = std::array<double, 2>;

/// The set-points of a drive's two channels.
inline std::array<Setpoint, 2> SetpointsFor(const WheelSpeeds& wheel_speed_rad_s) {
  return {Setpoint{wheel_speed_rad_s[0]}, Setpoint{wheel_speed_rad_s[1]}};
}

/// Clamps the turn rate of a drive with steered wheels to its maximum at this speed.
inline double LimitTurn(const DriveModel& drive, double linear_m_s, double angular_rad_s) {
  if (!drive.steering) return angular_rad_s;
  const double most = drive.steering->max_curvature_1_m * std::abs(linear_m_s);
  return std::clamp(angular_rad_s, -most, most);
}

/// Steering angles of the left and the right front wheel, rad, left positive.
inline std::array<double, 2> SteeringAngles(const DriveModel& drive, const WheelSpeeds& wheel_speed_rad_s) {
  const double middle = (wheel_speed_rad_s[0] + wheel_speed_rad_s[1]) / 2;
  if (middle == 0) return {};
  const double curvature = (wheel_speed_rad_s[1] - wheel_speed_rad_s[0]) / (drive.track_m * middle);
  const auto& [joints, wheelbase_m, half_track_m, most] = *drive.steering;
  const double kept = std::clamp(curvature, -most, most);
  return {portable::Atan(wheelbase_m * kept / (1 - kept * half_track_m)),
          portable::Atan(wheelbase_m * kept / (1 + kept * half_track_m))};
}

/// Scales both speeds into the limits by one factor, and multiplies `factor` by it. For a drive with steered
/// wheels, first reduces their difference to the maximum curvature. @pre finite
inline WheelSpeeds LimitWheels(const DriveModel& drive, WheelSpeeds wheel_speed_rad_s, double& factor) {
  if (drive.steering) {
    const double middle = wheel_speed_rad_s[0] / 2 + wheel_speed_rad_s[1] / 2;
    const double most = drive.steering->max_curvature_1_m * drive.track_m / 2 * std::abs(middle);
    const double half = wheel_speed_rad_s[1] / 2 - wheel_speed_rad_s[0] / 2;
    if (std::abs(half) > most) {
      wheel_speed_rad_s = {middle - std::copysign(most, half), middle + std::copysign(most, half)};
    }
  }
  const double fastest = std::max(std::abs(wheel_speed_rad_s[0]), std::abs(wheel_speed_rad_s[1]));
  if (fastest <= drive.max_wheel_speed_rad_s) return wheel_speed_rad_s;
  const double scale = drive.max_wheel_speed_rad_s / fastest;
  factor *= scale;
  for (double& wheel : wheel_speed_rad_s) {
    // Rounding must not exceed the limit again.
    wheel = std::clamp(wheel * scale, -drive.max_wheel_speed_rad_s, drive.max_wheel_speed_rad_s);
  }
  return wheel_speed_rad_s;
}

/// Wheel speeds for forward speed and turn rate, within the limits. Sets `factor` to the scale factor;
/// unchanged if nothing was scaled. Applies LimitTurn() to the turn rate first. @pre finite
inline WheelSpeeds WheelsFor(const DriveModel& drive, double linear_m_s, double angular_rad_s,
                             double& factor) {
  constexpr double kHuge = 1e100;  // beyond any limit, but divided by a radius still far from overflow
  const double largest = std::max(std::abs(linear_m_s), std::abs(angular_rad_s));
  if (largest > kHuge) {
    factor = kHuge / largest;
    linear_m_s *= factor;
    angular_rad_s *= factor;
  }
  angular_rad_s = LimitTurn(drive, linear_m_s, angular_rad_s);
  const double half_turn_m_s = angular_rad_s * drive.track_m / 2;
  return LimitWheels(drive,
                     {(linear_m_s - half_turn_m_s) / drive.wheel_radius_m,
                      (linear_m_s + half_turn_m_s) / drive.wheel_radius_m},
                     factor);
}

}  // namespace coopdyn
