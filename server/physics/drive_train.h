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
// so that a coupling keeps its energy; one that swings in a few steps goes over to the end's twist and rate,
// which damps, and so does what holds below a preload.
//
// Both lines fall: the more torque the coupling passes on, the slower the rotor; the faster the joint, the
// less torque. So T is a falling function of v' made of straight lines, however motor, gear, gap and preload
// bend it, and a sum of rows of the solver, each v + softness · share = target with a bounded share. They are
// solved with all that works on the joint, so no stiffness makes a step unstable.
#pragma once

#include <vector>

#include "server/model/drive_train.h"
#include "server/physics/joint_motor.h"
#include "server/state/frame.h"

namespace coopdyn {

/// What a motor does in a substep: m = S − s w, or, of a servo, what its row asks for up to that.
struct MotorLaw {
  bool is_servo = false;
  double torque = 0, slope = 0;               // S and s; of a servo those of its full duty
  double target = 0, softness = 0, most = 0;  // of a servo, as in JointRow
  double stall_current_a = 0, stall_torque_nm = 0, slope_nms_rad = 0;  // at the shaft, for its current
  bool draws = true;  // from the supply; a short-circuited motor does not
};

/// A corner of the line that says how the rotor ends for each torque of the coupling.
struct RotorPoint {
  double effort = 0, rate = 0, motor = 0;  // T, w', m
};

/// A drive train in one substep. Reused: its lists keep their memory.
struct TrainStep {
  MotorLaw law;
  std::vector<RotorPoint> rotor;  // by increasing effort
  std::vector<CouplingShare> shares;
};

/// What the motor of `joint` does on a set-point: the duty of kPwm, nothing if idle, else what `servo`, the
/// row of its servo on the rotor, asks for.
MotorLaw LawOf(const DriveTrainModel& train, const Setpoint& setpoint, const JointRow& servo);

/// Fills `step` for a substep of `dt_s` of a joint at `place`, which moves `inertia_kg_m2`.
void PlanTrain(const DriveTrainModel& train, const DriveTrainState& state, const JointPlace& place,
               double inertia_kg_m2, double dt_s, TrainStep& step);

/// Moves rotor, current and energy on by a substep in which the coupling gave the joint `effort`.
void AdvanceTrain(const DriveTrainModel& train, const TrainStep& step, double effort, double dt_s,
                  DriveTrainState& state);

/// The friction of the joint, which turns at this rate.
double FrictionOf(const DriveTrainModel& train, double rate);

}  // namespace coopdyn
