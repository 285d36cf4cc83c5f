// SPDX-License-Identifier: MIT
// Drive trains of joints: a rotor, which the motor turns, and the joint are two masses with a coupling
// between them. Pure.
//
// All on the joint's side of the gear (ratio n: J = n² J_rotor, s = n² of the motor's slope), with w the rate
// of the rotor, v that of the joint, T the torque of the coupling on the joint:
//
//   J (w' − w) / dt = m(w') − load(T, w')                      rotor; m: motor, load: T through the gear
//   twist' = twist + dt (w' − v'),  T = coupling(twist + dt/4 (u' − u), (u' + u) / 2),  u = w − v
//
// So a coupling conserves its energy. A coupling that swings within a few steps changes over to the twist and
// rate of the step's end, which damps; so does a coupling below its preload.
//
// Both relations decrease: the more torque the coupling passes on, the slower the rotor; the faster the
// joint, the less torque. So T is a decreasing, piecewise linear function of v' for any motor, gear, gap and
// preload. It is a sum of solver rows, each v + softness · share = target with a bounded share. The rows are
// solved together with everything else that acts on the joint, so no stiffness makes a step unstable.
#pragma once

#include <vector>

#include "server/model/drive_train.h"
#include "server/physics/joint_motor.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A motor's torque in a substep: m = S − s w; for a servo, the torque that its row demands, within ± S − s
/// w.
struct MotorLaw {
  bool is_servo = false;
  double torque = 0, slope = 0;                                        // S and s; of a servo: at full duty
  double target = 0, softness = 0, most = 0;                           // of a servo, as in JointRow
  double stall_current_a = 0, stall_torque_nm = 0, slope_nms_rad = 0;  // at the shaft, to compute the current
  bool draws = true;  // draws from the supply; a short-circuited motor does not
};

/// A corner of the piecewise linear relation between the coupling's torque and the rotor's rate at the
/// substep's end.
struct RotorPoint {
  double effort = 0, rate = 0, motor = 0;  // T, w', m
};

/// A drive train in one substep. Reused, so that its lists keep their memory.
struct TrainStep {
  MotorLaw law;
  std::vector<RotorPoint> rotor;  // by increasing effort
  std::vector<CouplingShare> shares;
};

/// The motor's law for a set-point: the duty of kPwm, nothing in kIdle, else the demand of `servo`, its
/// servo's row on the rotor.
MotorLaw LawOf(const DriveTrainModel& train, const Setpoint& setpoint, const JointRow& servo);

/// Fills `step` for a substep of `dt_s`. `place`: of the joint; `inertia_kg_m2`: moved by the joint.
void PlanTrain(const DriveTrainModel& train, const DriveTrainState& state, const JointPlace& place,
               double inertia_kg_m2, double dt_s, TrainStep& step);

/// Advances rotor, current and energy by a substep in which the coupling applied `effort` to the joint.
void AdvanceTrain(const DriveTrainModel& train, const TrainStep& step, double effort, double dt_s,
                  DriveTrainState& state);

/// Friction torque of the joint at this rate, N m.
double FrictionOf(const DriveTrainModel& train, double rate);

}  // namespace coopdyn
