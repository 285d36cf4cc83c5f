// SPDX-License-Identifier: MIT
// The drive train of a joint of a control board: motor, rotor, gear, backlash, coupling. Constant once read.
#pragma once

#include <limits>
#include <vector>

namespace coopdyn {

/// What a motor gives at one duty of its PWM, at its shaft.
struct PwmRow {
  double duty = 1;  // above 0, at most 1
  double no_load_speed_rad_s = 0;
  double stall_torque_nm = 0;
  double stall_current_a = 0;  // 0: not known, and no current is told
};

/// A rotor with a gear, which turns the joint through a coupling with backlash. What is said of the shaft is
/// on the motor's side of the gear, all else on the joint's.
struct DriveTrainModel {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::vector<PwmRow> pwm;            // by increasing duty, at least one
  double ratio = 1;                   // turns of the shaft per turn of the joint
  double efficiency = 1;              // of the gear, in both directions
  double rotor_inertia_kg_m2 = 1e-6;  // about the shaft, with the gear's
  double brake_nms_rad = 0;           // of the shaft, if the motor is short-circuited
  double backlash_rad = 0;            // the whole gap
  double stiffness_nm_rad = kInfinity;
  double damping_nms_rad = 0;
  double preload_nm = 0;  // of the prestressed spring: it gives way beyond this torque
  double static_friction_nm = 0, dynamic_friction_nm = 0;  // of the joint
  double stiction_speed_rad_s = 1e-3;                      // below it the static friction counts

  bool is_rigid() const { return stiffness_nm_rad == kInfinity; }
};

/// The row of a duty from 0 to 1, linear between those of the model and from a motor that gives nothing.
PwmRow RowAt(const DriveTrainModel& train, double duty);

}  // namespace coopdyn
