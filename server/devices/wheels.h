// SPDX-License-Identifier: MIT
// From what a client wants of a drive to the speeds of its wheels, within their limits. Pure; any thread.
//
//   left  = (linear − angular · track / 2) / wheel radius        rad/s
//   right = (linear + angular · track / 2) / wheel radius        rad/s
//
// linear in m/s forward, angular in rad/s, left positive. If a wheel would be faster than its limit both are
// scaled by the same factor, so that the curvature stays.
#pragma once

#include "server/model/robot_model.h"
#include "server/state/command_board.h"

namespace coopdyn {

/// Scales both speeds by one factor into the limits, and `factor` with them. @pre finite
Setpoint LimitWheels(const DriveModel& drive, Setpoint wheel_speed_rad_s, double& factor);
/// Wheel speeds for forward speed and turn rate, within the limits; `factor`: by how much they were scaled,
/// untouched if not at all. @pre finite
Setpoint WheelsFor(const DriveModel& drive, double linear_m_s, double angular_rad_s, double& factor);

}  // namespace coopdyn
