// SPDX-License-Identifier: MIT
// The checks: each section tests robots of devices.scenario through the clients of YARP's own devices.
#pragma once

#include "checks.h"

namespace coopdyn {

/// A control board: its values, moves to positions, modes (board_checks.cc).
void CheckBoard(Checks& checks);
/// Torques, impedances, PIDs, and refused calls (board_force_checks.cc).
void CheckForces(Checks& checks);
/// IMU, wrench, lidar, camera, odometry and drive.
void CheckSensors(Checks& checks);
/// One unchanged module with two robots at the same time.
void CheckSweep(Checks& checks);
/// A thread with a period of 1 ms on the simulated clock for N simulated seconds, at two speeds.
void CheckClock(Checks& checks, double seconds);
/// The same in lockstep, where each step waits for this program.
void CheckLockstep(Checks& checks, double seconds);

}  // namespace coopdyn
