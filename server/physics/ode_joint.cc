// SPDX-License-Identifier: MIT
#include "server/physics/ode_joint.h"

#include <algorithm>
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
  dBodyID parent = bodies[static_cast<std::size_t>(of.parent)],
          child = bodies[static_cast<std::size_t>(of.child)];
  const Vector3 &p = of.p_RJ, &a = of.axis_R, &b = of.axis2_R;
  if (of.kind == JointModel::Kind::kBall) {
    dJointID ball = dJointCreateBall(world, nullptr);
    dJointAttach(ball, child, parent);
    dJointSetBallAnchor(ball, p.x(), p.y(), p.z());
    return ball;
  }
  if (of.kind == JointModel::Kind::kUniversal) {
    dJointID universal = dJointCreateUniversal(world, nullptr);
    dJointAttach(universal, parent, child);  // the first axis is the parent's
    dJointSetUniversalAnchor(universal, p.x(), p.y(), p.z());
    dJointSetUniversalAxis1(universal, a.x(), a.y(), a.z());
    dJointSetUniversalAxis2(universal, b.x(), b.y(), b.z());
    return universal;
  }
  const bool slides = of.kind == JointModel::Kind::kSlider;
  dJointID joint = slides ? dJointCreateSlider(world, nullptr) : dJointCreateHinge(world, nullptr);
  dJointAttach(joint, child, parent);  // so that its rate is the child's
  if (slides) {
    dJointSetSliderAxis(joint, a.x(), a.y(), a.z());
  } else {
    dJointSetHingeAnchor(joint, p.x(), p.y(), p.z());
    dJointSetHingeAxis(joint, a.x(), a.y(), a.z());
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

JointLever LeverOf(dJointID joint) {
  JointLever lever{};
  if (Slides(joint)) {
    dJointGetSliderAxis(joint, lever.axis);
    return lever;
  }
  dJointGetHingeAxis(joint, lever.axis);
  dJointGetHingeAnchor(joint, lever.arm);
  const dReal* const center = dBodyGetPosition(dJointGetBody(joint, 0));
  for (int i = 0; i < 3; ++i) lever.arm[i] -= center[i];
  return lever;
}

double MeasuredEffort(dJointID joint, const dJointFeedback& force, const JointLever& lever) {
  const dReal *const axis = lever.axis, *const r = lever.arm, *const f = force.f1;
  if (Slides(joint)) return axis[0] * f[0] + axis[1] * f[1] + axis[2] * f[2];
  // ODE's torque is about the centre of mass: what the hinge's forces give there is not the motor's.
  return axis[0] * (force.t1[0] - (r[1] * f[2] - r[2] * f[1])) +
         axis[1] * (force.t1[1] - (r[2] * f[0] - r[0] * f[2])) +
         axis[2] * (force.t1[2] - (r[0] * f[1] - r[1] * f[0]));
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

void Drive(dJointID joint, const JointRow& row, double dt_s) {
  // A stop pushes out no faster than this: it does not bounce.
  constexpr double kMaxPushOut = 0.1;  // rad/s or m/s
  const double depth = std::min(row.depth, kMaxPushOut * dt_s);
  // Without stops ODE would not look, and keep to the last one: they stand far enough away instead.
  constexpr double kFar = 1;
  const double position = PositionOf(joint);
  SetParam(joint, dParamLoStop, -dInfinity);
  SetParam(joint, dParamHiStop, row.stop > 0 ? position - depth : position + kFar);
  SetParam(joint, dParamLoStop, row.stop < 0 ? position + depth : position - kFar);
  SetParam(joint, dParamFMax, row.max_effort);
  SetParam(joint, dParamVel, row.velocity);
  SetParam(joint, dParamCFM, row.softness);
  if (row.effort != 0) Push(joint, row.effort);
}

}  // namespace coopdyn
