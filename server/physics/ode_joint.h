// SPDX-License-Identifier: MIT
// A robot's joint in ODE: how it is made, what works on it in a substep, and what it measures. Only
// server/physics includes this file. One thread at a time, that of the lane.
#pragma once

#include <vector>

#include "server/model/robot_model.h"
#include "server/physics/joint_motor.h"
#include "server/physics/ode.h"

namespace coopdyn {

/// The joint of a robot that stands at the origin; `bodies`: of its links.
dJointID MakeJoint(dWorldID world, const JointModel& of, const std::vector<dBodyID>& bodies);

/// Where it is, rad (from -π to π) or m, and how fast, rad/s or m/s.
double PositionOf(dJointID joint);
double RateOf(dJointID joint);
/// `position`, which may be beyond ±π, as near to the last one as the joint's place allows.
double Unwrap(dJointID joint, double last);
/// Where a joint's efforts act on its child: its axis, and the way from the centre of mass to the joint.
struct JointLever {
  dVector3 axis, arm;
};
JointLever LeverOf(dJointID joint);
/// What its motor or stop gave about its axis in a step, before which it had this lever. N m or N.
double MeasuredEffort(dJointID joint, const dJointFeedback& force, const JointLever& lever);

/// Spring and damper of a joint without a motor, implicit over the step of `dt_s`, so that they are stable
/// however stiff. Without them its friction.
void Resist(dJointID joint, const JointModel& of, double dt_s);
/// Lets the motor of a control board do what `row` says in the coming substep.
void Drive(dJointID joint, const JointRow& row, double dt_s);

}  // namespace coopdyn
