// SPDX-License-Identifier: MIT
// The closed form of a robot that stands upright on its wheels and touches nothing else: it moves along the
// exact arc of its wheels' speeds, as fast as motors and grip let it get there. Pure functions of one robot's
// state; any thread. Only server/physics includes this file.
#pragma once

#include <array>

#include "server/physics/mechanism.h"
#include "server/state/frame.h"

namespace coopdyn {

// A robot this near to rest upright on its floor is put there exactly.
inline constexpr double kRestHeight_m = 2e-5;
inline constexpr double kRestTilt_rad = 2e-4;
inline constexpr double kRestSink_m_s = 2e-3;
inline constexpr double kRestTurn_rad_s = 2e-2;

/// Speeds of one substep.
struct DrivePlan {
  bool closed = false;  // the closed form holds, as far as this robot's own state says
  double forward_m_s = 0;
  double turn_rad_s = 0;
  std::array<double, 2> wheels_rad_s{};  // as turned
};

/// True if the body is upright at height `rest_z_m` (of its centre of mass), within the tolerances above.
bool StandsUpright(const BodyState& body, double rest_z_m);

/// What the drive does in the next `dt_s`. `closed` is false if the robot is not upright at rest, or if its
/// acceleration would make it slide sideways or tip.
DrivePlan PlanDrive(const OneBodyDrive& drive, const BodyState& body, double rest_z_m,
                    const std::array<double, 2>& setpoint_rad_s, double dt_s);

/// Moves `body` by `plan`. @pre plan.closed.
void Advance(const OneBodyDrive& drive, const DrivePlan& plan, double rest_z_m, double dt_s, BodyState& body);

}  // namespace coopdyn
