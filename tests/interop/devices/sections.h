// SPDX-License-Identifier: MIT
// What can be checked: each with the robots of devices.scenario, through the clients of YARP's own devices.
#pragma once

#include "checks.h"

namespace coopdyn {

/// A control board: what it tells, ways to positions, modes (board_checks.cc).
void CheckBoard(Checks& checks);
/// Torques, impedances, PIDs, and what is refused (board_force_checks.cc).
void CheckForces(Checks& checks);
/// IMU, wrench, lidar, camera, odometry and drive.
void CheckSensors(Checks& checks);
/// One module, unchanged, with two robots at once.
void CheckSweep(Checks& checks);
/// A thread with a period of 1 ms on the simulated clock for so many simulated seconds, at two speeds.
void CheckClock(Checks& checks, double seconds);
/// The same in lockstep, where each step waits for this program.
void CheckLockstep(Checks& checks, double seconds);

}  // namespace coopdyn
