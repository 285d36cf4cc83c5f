// SPDX-License-Identifier: MIT
#include "server/physics/ode_joint.h"

#include <cmath>
#include <numbers>

namespace coopdyn {

namespace {

bool Slides(dJointID joint) {
  return dJointGetType(joint) == dJointTypeSlider;
}

void SetParam(dJointID joint, int parameter, double value) {
  Slides(joint) ? dJointSetSliderParam(joint, parameter, value)
                : dJointSetHingeParam(joint, parameter, value);
}

void Push(dJointID joint, double effort) {
  Slides(joint) ? dJointAddSliderForce(joint, effort) : dJointAddHingeTorque(joint, effort);
}

}  // namespace

dJointID MakeJoint(dWorldID world, const JointModel& of, const std::vector<dBodyID>& bodies) {
  const bool slides = of.kind == JointModel::Kind::kSlider;
  dJointID joint = slides ? dJointCreateSlider(world, nullptr) : dJointCreateHinge(world, nullptr);
  dJointAttach(joint, bodies[static_cast<std::size_t>(of.child)],
               bodies[static_cast<std::size_t>(of.parent)]);  // so that its rate is the child's
  if (slides) {
    dJointSetSliderAxis(joint, of.axis_R.x(), of.axis_R.y(), of.axis_R.z());
  } else {
    dJointSetHingeAnchor(joint, of.p_RJ.x(), of.p_RJ.y(), of.p_RJ.z());
    dJointSetHingeAxis(joint, of.axis_R.x(), of.axis_R.y(), of.axis_R.z());
  }
  // Twice: ODE takes a lower stop only if it is not above the upper one, and the other way round.
  for (int i = 0; i < 2; ++i) {
    if (std::isfinite(of.lower)) SetParam(joint, dParamLoStop, of.lower);
    if (std::isfinite(of.upper)) SetParam(joint, dParamHiStop, of.upper);
  }
  return joint;
}

double PositionOf(dJointID joint) {
  return Slides(joint) ? dJointGetSliderPosition(joint) : dJointGetHingeAngle(joint);
}

double RateOf(dJointID joint) {
  return Slides(joint) ? dJointGetSliderPositionRate(joint) : dJointGetHingeAngleRate(joint);
}

double Unwrap(dJointID joint, double last) {
  if (Slides(joint)) return dJointGetSliderPosition(joint);
  return last + std::remainder(dJointGetHingeAngle(joint) - last, 2 * std::numbers::pi);
}

double MeasuredEffort(dJointID joint, const dJointFeedback& force) {
  dVector3 axis;
  if (Slides(joint)) {
    dJointGetSliderAxis(joint, axis);
    return axis[0] * force.f1[0] + axis[1] * force.f1[1] + axis[2] * force.f1[2];
  }
  dJointGetHingeAxis(joint, axis);
  // ODE's torque is about the centre of mass: what the hinge's forces give there is not the motor's.
  dVector3 anchor;
  dJointGetHingeAnchor(joint, anchor);
  const dReal* const center = dBodyGetPosition(dJointGetBody(joint, 0));
  const double x = anchor[0] - center[0], y = anchor[1] - center[1], z = anchor[2] - center[2];
  const dReal* const f = force.f1;
  return axis[0] * (force.t1[0] - (y * f[2] - z * f[1])) + axis[1] * (force.t1[1] - (z * f[0] - x * f[2])) +
         axis[2] * (force.t1[2] - (x * f[1] - y * f[0]));
}

void Resist(dJointID joint, const JointModel& of, double dt_s) {
  const double resistance = of.damping + dt_s * of.stiffness;
  const double position = PositionOf(joint);
  if (position <= of.lower || position >= of.upper) {
    // ODE's row is the stop's then, and it would add the whole of FMax to it.
    SetParam(joint, dParamFMax, 0);
    Push(joint, -of.stiffness * (position - of.rest));
  } else if (resistance > 0) {
    // ODE's motor row is v + cfm λ = v_target.
    SetParam(joint, dParamFMax, dInfinity);
    SetParam(joint, dParamCFM, 1 / resistance);
    SetParam(joint, dParamVel, -of.stiffness * (position - of.rest) / resistance);
  } else {
    SetParam(joint, dParamFMax, of.friction);
  }
}

void Drive(dJointID joint, const JointRow& row) {
  SetParam(joint, dParamLoStop, -dInfinity);
  SetParam(joint, dParamHiStop, dInfinity);
  if (row.stop < 0) SetParam(joint, dParamLoStop, PositionOf(joint) + row.depth);
  if (row.stop > 0) SetParam(joint, dParamHiStop, PositionOf(joint) - row.depth);
  SetParam(joint, dParamFMax, row.max_effort);
  SetParam(joint, dParamVel, row.velocity);
  SetParam(joint, dParamCFM, row.softness);
  if (row.effort != 0) Push(joint, row.effort);
}

}  // namespace coopdyn
