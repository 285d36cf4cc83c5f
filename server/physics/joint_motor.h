// SPDX-License-Identifier: MIT
// Motors of control boards' joints: what they do in a substep, by mode, profile and compliance. Pure.
//
// Everything is a row of the solver, v + softness · effort = velocity with |effort| ≤ max_effort, so it is
// implicit and stable at any step length. A servo asks for the velocity that brings the joint to its
// reference:
//
//   v = ṙ + min(p, 1/dt) (r − q) + i ∫(r − q) dt + d (ṙ − q̇)
//
// A compliance is a spring and a damper at the reference: effort = k (r − q) − d q̇ + offset, whose row is
// softness = 1 / (d + dt k), velocity = softness (k (r − q) + offset). The solver, which knows the inertia
// that the joint moves, evaluates the force of such springs and dampers in the middle of the substep. Minimum
// jerk: Flash and Hogan (1985), J. Neurosci. 5(7), generalised to a start in motion by the quintic with the
// same end conditions.
#pragma once

#include <span>

#include "server/model/robot_model.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A share of a drive train's effort on its joint: v + softness · effort = target, with bounded effort.
struct CouplingShare {
  double target = 0, softness = 0;
  double lower = 0, upper = 0;
};

/// A joint's solver row in one substep. rad, N m; for sliders m, N.
struct JointRow {
  double velocity = 0;
  double max_effort = 0;
  double softness = 0;  // velocity per effort
  int stop = 0;         // −1 or 1: the lower or upper stop holds the joint
  double gap = 0;       // distance to the stop; negative: beyond it
  double effort = 0;    // additional, independent of the velocity
  /// Of the spring and damper that `velocity` and `softness` contain, with the forces of the substep's end.
  double stiffness = 0, damping = 0;
  double friction = 0;  // additional, against the motion
  /// For a joint with a drive train, replaces all of the above. Empty if it has none.
  std::span<const CouplingShare> shares = {};
};

/// A joint's state at the start of a substep.
struct JointPlace {
  double position = 0, velocity = 0;
  double load = 0;  // effort that carries the weight beyond it, if the board compensates gravity; else 0
};

/// Puts `next` in force after `last` without a jump: a new motion begins where the last one is.
void Plan(const JointModel& joint, BoardModel::Profile profile, const JointPlace& place, const Setpoint& last,
          const Setpoint& next, JointControl& control);

/// Advances the reference by a substep of `dt_s` and returns what the motor does in it. `left`: the step's
/// remaining substeps, including this one.
JointRow Advance(const JointModel& joint, BoardModel::Profile profile, const JointPlace& place,
                 const Setpoint& setpoint, double dt_s, int left, JointControl& control);

/// The greatest effort of a motor: `most`, or less if its limiter's set-point says so.
double LimitedEffort(double most, const Setpoint& limiter);

/// Whether a motion to a position is unfinished.
bool IsUnderWay(const Setpoint& setpoint, const JointControl& control);

}  // namespace coopdyn
