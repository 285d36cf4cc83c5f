// SPDX-License-Identifier: MIT
// The drive train of a control board's joint: motor, rotor, gear, backlash, coupling. Immutable once read.
#pragma once

#include <limits>
#include <vector>

namespace coopdyn {

/// A motor's characteristics at its shaft for one PWM duty.
struct PwmRow {
  double duty = 1;  // above 0, at most 1
  double no_load_speed_rad_s = 0;
  double stall_torque_nm = 0;
  double stall_current_a = 0;  // 0: unknown; no current is reported
};

/// A rotor with a gear that turns the joint through a coupling with backlash. Values of the shaft are on the
/// motor's side of the gear, all others on the joint's.
struct DriveTrainModel {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::vector<PwmRow> pwm;            // by increasing duty, at least one row
  double ratio = 1;                   // shaft turns per joint turn
  double efficiency = 1;              // of the gear, in both directions
  double rotor_inertia_kg_m2 = 1e-6;  // about the shaft, including the gear
  double brake_nms_rad = 0;           // damping of the shaft with a short-circuited motor
  double backlash_rad = 0;            // the full gap
  double stiffness_nm_rad = kInfinity;
  double damping_nms_rad = 0;
  double preload_nm = 0;                                   // the prestressed spring yields beyond this torque
  double static_friction_nm = 0, dynamic_friction_nm = 0;  // of the joint
  double stiction_speed_rad_s = 1e-3;                      // static friction applies below this speed

  bool is_rigid() const { return stiffness_nm_rad == kInfinity; }
};

/// The row for a duty from 0 to 1, interpolated linearly between the model's rows; duty 0 gives nothing.
PwmRow RowAt(const DriveTrainModel& train, double duty);

}  // namespace coopdyn
