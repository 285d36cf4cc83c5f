// SPDX-License-Identifier: MIT
// The joints of control boards: what their motors do in a substep, by mode, profile and compliance. Pure.
//
// Everything is a row of the solver, v + softness · effort = velocity with |effort| ≤ max_effort, so it is
// implicit and stable at any step. A servo asks for the velocity that brings the joint to its reference:
//
//   v = ṙ + min(p, 1/dt) (r − q) + i ∫(r − q) dt + d (ṙ − q̇)
//
// A compliance is a spring and a damper at the reference: effort = k (r − q) − d q̇ + offset, whose row is
// softness = 1 / (d + dt k), velocity = softness (k (r − q) + offset). The solver, which knows what the joint
// moves, takes the force of springs and dampers such as these in the middle of the substep. Minimum jerk:
// Flash and Hogan (1985), J. Neurosci. 5(7), generalised to a start in motion by the quintic with the same
// end conditions.
#pragma once

#include <span>

#include "server/model/robot_model.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A share of what a drive train gives to its joint: v + softness · effort = target, within bounds.
struct CouplingShare {
  double target = 0, softness = 0;
  double lower = 0, upper = 0;
};

/// What a joint's row does in one substep. rad, N m; of a slider m, N.
struct JointRow {
  double velocity = 0;
  double max_effort = 0;
  double softness = 0;  // velocity per effort
  int stop = 0;         // −1 or 1: the lower or upper stop holds it
  double gap = 0;       // to the stop; negative: so far beyond it
  double effort = 0;    // besides, whatever the velocity
  /// Of the spring and damper in velocity and softness, whose forces there are those of the substep's end.
  double stiffness = 0, damping = 0;
  double friction = 0;  // against the motion, besides
  /// Of a joint with a drive train, instead of all the above; empty: it has none.
  std::span<const CouplingShare> shares = {};
};

/// Where a joint is at the start of a substep.
struct JointPlace {
  double position = 0, velocity = 0;
  double load = 0;  // effort that carries the weight beyond it, if the board compensates it; else 0
};

/// Takes `next` in force after `last`, so that nothing jumps: a new way begins where the last one is.
void Plan(const JointModel& joint, BoardModel::Profile profile, const JointPlace& place, const Setpoint& last,
          const Setpoint& next, JointControl& control);

/// Moves the reference on by a substep of `dt_s`, of which `left` are to come in this step (this one
/// included), and returns what the motor does meanwhile.
JointRow Advance(const JointModel& joint, BoardModel::Profile profile, const JointPlace& place,
                 const Setpoint& setpoint, double dt_s, int left, JointControl& control);

/// The greatest effort of a motor that gives `most`, by the set-point of its limiter.
double LimitedEffort(double most, const Setpoint& limiter);

/// Whether the way to a position has not ended.
bool IsUnderWay(const Setpoint& setpoint, const JointControl& control);

}  // namespace coopdyn
