// SPDX-License-Identifier: MIT
// From what somebody wants of a drive to the speeds of its wheels, within their limits. Pure; any thread.
//
//   left  = (linear − angular · track / 2) / wheel radius        rad/s
//   right = (linear + angular · track / 2) / wheel radius        rad/s
//
// linear in m/s forward, angular in rad/s, left positive. If a wheel would be faster than its limit both are
// scaled by the same factor, so that the curvature stays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "server/model/robot_model.h"

namespace coopdyn {

/// Left, right, rad/s.
using WheelSpeeds = std::array<double, 2>;

/// The set-points of a drive's two channels.
inline std::array<Setpoint, 2> SetpointsFor(const WheelSpeeds& wheel_speed_rad_s) {
  return {Setpoint{wheel_speed_rad_s[0]}, Setpoint{wheel_speed_rad_s[1]}};
}

/// Scales both speeds by one factor into the limits, and `factor` with them. @pre finite
inline WheelSpeeds LimitWheels(const DriveModel& drive, WheelSpeeds wheel_speed_rad_s, double& factor) {
  const double fastest = std::max(std::abs(wheel_speed_rad_s[0]), std::abs(wheel_speed_rad_s[1]));
  if (fastest <= drive.max_wheel_speed_rad_s) return wheel_speed_rad_s;
  const double scale = drive.max_wheel_speed_rad_s / fastest;
  factor *= scale;
  for (double& wheel : wheel_speed_rad_s) {
    // Rounding must not bring it beyond the limit again.
    wheel = std::clamp(wheel * scale, -drive.max_wheel_speed_rad_s, drive.max_wheel_speed_rad_s);
  }
  return wheel_speed_rad_s;
}

/// Wheel speeds for forward speed and turn rate, within the limits; `factor`: by how much they were scaled,
/// untouched if not at all. @pre finite
inline WheelSpeeds WheelsFor(const DriveModel& drive, double linear_m_s, double angular_rad_s,
                             double& factor) {
  constexpr double kHuge = 1e100;  // beyond any limit, and still far from overflow when divided by a radius
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
