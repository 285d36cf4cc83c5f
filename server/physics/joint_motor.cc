// SPDX-License-Identifier: MIT
#include "server/physics/joint_motor.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

using Profile = BoardModel::Profile;

struct Way {
  double position = 0, velocity = 0, acceleration = 0;
};

/// The quintic from the start (position, velocity, acceleration) to rest at the target, at the share `s` of
/// its duration.
Way MinimumJerk(const JointControl& control, double s) {
  const double T = control.duration_s;
  if (T <= 0) return {control.target};
  const double D = control.target - control.start, w = control.start_velocity * T;
  const double c = control.start_acceleration * T * T / 2;
  const double a3 = 10 * D - 6 * w - 3 * c, a4 = -15 * D + 8 * w + 3 * c, a5 = 6 * D - 3 * w - c;
  const double position = control.start + s * (w + s * (c + s * (a3 + s * (a4 + s * a5))));
  const double slope = w + s * (2 * c + s * (3 * a3 + s * (4 * a4 + s * 5 * a5)));
  const double curve = 2 * c + s * (6 * a3 + s * (12 * a4 + s * 20 * a5));
  return {position, slope / T, curve / (T * T)};
}

/// Whether the quintic keeps to the profile's limits, or to its start values if they exceed the limits.
bool KeepsTo(const JointControl& control) {
  constexpr int kSamples = 32;
  const double fastest = std::max(control.speed, std::abs(control.start_velocity)) * (1 + 1e-9);
  const double most = std::max(control.acceleration, std::abs(control.start_acceleration)) * (1 + 1e-3);
  for (int k = 0; k <= kSamples; ++k) {
    const Way way = MinimumJerk(control, static_cast<double>(k) / kSamples);
    if (std::abs(way.velocity) > fastest || std::abs(way.acceleration) > most) return false;
  }
  return true;
}

/// The shortest duration with which the quintic keeps to the profile; from rest in closed form.
double DurationOf(JointControl control) {
  constexpr double kPeakSpeed = 1.875, kPeakAcceleration = 5.773502691896258;  // 15/8, 10/√3
  constexpr double kGrowth = 1.05, kBriefest_s = 1e-2;
  const double way = std::abs(control.target - control.start);
  control.duration_s =
      std::max({kPeakSpeed * way / control.speed, std::sqrt(kPeakAcceleration * way / control.acceleration),
                std::abs(control.start_velocity) / control.acceleration,
                control.start_acceleration == 0 ? 0 : kBriefest_s});
  if (control.start_velocity == 0 && control.start_acceleration == 0) return control.duration_s;
  for (int i = 0; i < 200 && !KeepsTo(control); ++i) control.duration_s *= kGrowth;
  return control.duration_s;
}

/// One substep of the fastest motion within speed and acceleration. `start_velocity` is the reference's.
Way Trapezoidal(const JointControl& control, double dt_s) {
  const double way = control.target - control.reference, slack = control.acceleration * dt_s / 2;
  const double stopping = std::sqrt(slack * slack + 2 * control.acceleration * std::abs(way)) - slack;
  const double wanted = std::copysign(std::min({control.speed, stopping, std::abs(way) / dt_s}), way);
  const double change = control.acceleration * dt_s;
  const double velocity =
      control.start_velocity + std::clamp(wanted - control.start_velocity, -change, change);
  const double position = control.reference + velocity * dt_s;
  const bool arrives =
      std::abs(control.target - position) < 1e-12 && std::abs(velocity) <= change * (1 + 1e-9);
  return arrives ? Way{control.target, 0} : Way{position, velocity};
}

/// The reference's current velocity and acceleration.
Way OnWay(Profile profile, const JointControl& control) {
  if (profile == Profile::kTrapezoidal) return {control.reference, control.start_velocity};
  if (control.elapsed_s >= control.duration_s) return {control.reference};
  return MinimumJerk(control, control.elapsed_s / control.duration_s);
}

/// Moves the reference by a substep; returns its velocity.
double MoveReference(Profile profile, const Setpoint& setpoint, double dt_s, int left,
                     JointControl& control) {
  const double before = control.reference;
  if (setpoint.mode == ControlMode::kDirect) {
    control.reference = left <= 1 ? control.target : before + (control.target - before) / left;
  } else if (profile == Profile::kTrapezoidal) {
    const Way way = Trapezoidal(control, dt_s);
    control.reference = way.position;
    control.start_velocity = way.velocity;
  } else {
    control.elapsed_s = std::min(control.elapsed_s + dt_s, control.duration_s);
    const bool ended = control.elapsed_s >= control.duration_s;
    control.reference =
        ended ? control.target : MinimumJerk(control, control.elapsed_s / control.duration_s).position;
  }
  return (control.reference - before) / dt_s;
}

/// The stop that a joint meets in a substep if its motor alone does not hold it: −1, 1, or 0 for none.
int MetStop(const JointModel& joint, const JointPlace& place, bool servo, double dt_s) {
  constexpr double kDeepest = 1e-3;  // rad or m
  const double next = place.position + dt_s * place.velocity, slack = servo ? kDeepest : 0;
  if (place.position <= joint.lower - slack || next < joint.lower - kDeepest) return -1;
  if (place.position >= joint.upper + slack || next > joint.upper + kDeepest) return 1;
  return 0;
}

/// The row of a joint that its stop holds while the motor pushes with `effort`.
JointRow StopRow(const JointModel& joint, const JointPlace& place, int stop, double effort) {
  JointRow row;
  row.stop = stop;
  row.gap = stop < 0 ? place.position - joint.lower : joint.upper - place.position;
  row.effort = effort;
  return row;
}

/// The row of an effort, with the joint's own damper, spring and friction.
JointRow EffortRow(const JointModel& joint, const JointPlace& place, int stop, double effort, double dt_s) {
  const double total = std::clamp(effort + place.load, -joint.max_effort, joint.max_effort);
  const double resistance = joint.damping + dt_s * joint.stiffness;
  const double spring = -joint.stiffness * (place.position - joint.rest);
  if (stop != 0) return StopRow(joint, place, stop, total + spring);
  if (std::abs(place.velocity) >= joint.max_velocity && total * place.velocity > 0) {
    return {std::copysign(joint.max_velocity, total), std::abs(total)};
  }
  if (resistance > 0) {
    JointRow row{(total + spring) / resistance, JointModel::kInfinity, 1 / resistance};
    row.stiffness = joint.stiffness;
    row.damping = joint.damping;
    row.friction = joint.friction;
    return row;
  }
  if (std::abs(total) <= joint.friction) return {0, joint.friction - std::abs(total)};
  return {std::copysign(joint.max_velocity, total), std::abs(total) - joint.friction};
}

/// The row of a velocity, up to the motor's effort. Does not drive the joint into a stop.
JointRow VelocityRow(const JointModel& joint, const JointPlace& place, int stop, double velocity,
                     double dt_s) {
  if (stop != 0) return StopRow(joint, place, stop, 0);
  velocity = std::clamp(velocity, -joint.max_velocity, joint.max_velocity);
  velocity = std::max(std::min(velocity, (joint.upper - place.position) / dt_s),
                      (joint.lower - place.position) / dt_s);
  return {velocity, joint.max_effort};
}

}  // namespace

void Plan(const JointModel& joint, Profile profile, const JointPlace& place, const Setpoint& last,
          const Setpoint& next, JointControl& control) {
  const auto is_place = [](const Setpoint& of) {
    return of.mode == ControlMode::kPosition || of.mode == ControlMode::kDirect;
  };
  const double reference = Limit(joint, next).reference;
  if (!is_place(next)) {
    control.reference = reference;
    control.integral = 0;
    return;
  }
  const bool goes = next.mode == ControlMode::kPosition;
  bool on_way = last.mode == ControlMode::kPosition && goes;
  if (on_way && reference == control.target) return;
  // Something keeps the joint from its reference: the new motion begins at the joint.
  constexpr double kFar = 0.05;  // rad or m
  const bool kept =
      goes && !std::isfinite(control.stiffness) && std::abs(control.reference - place.position) > kFar;
  on_way = on_way && !kept;
  const Way now = on_way ? OnWay(profile, control) : Way{0, place.velocity};
  if (!is_place(last) || kept) {
    control.reference = place.position;
    control.integral = 0;
  }
  control.start = control.reference;
  control.target = reference;
  control.start_velocity = goes ? now.velocity : 0;
  control.start_acceleration = goes ? now.acceleration : 0;
  control.elapsed_s = 0;
  control.duration_s = goes && profile == Profile::kMinimumJerk ? DurationOf(control) : 0;
}

JointRow Advance(const JointModel& joint, Profile profile, const JointPlace& place, const Setpoint& setpoint,
                 double dt_s, int left, JointControl& control) {
  const bool is_place = setpoint.mode == ControlMode::kPosition || setpoint.mode == ControlMode::kDirect;
  const bool compliant = is_place && std::isfinite(control.stiffness);
  const bool servo = (is_place && !compliant) || setpoint.mode == ControlMode::kVelocity;
  const int stop = MetStop(joint, place, servo, dt_s);
  if (setpoint.mode == ControlMode::kVelocity) {
    return VelocityRow(joint, place, stop, control.reference, dt_s);
  }
  if (!is_place) {
    const bool pushes = setpoint.mode == ControlMode::kEffort;
    return EffortRow(joint, place, stop, pushes ? control.reference : 0, dt_s);
  }
  const double error = control.reference - place.position;  // before the substep
  const double rate = MoveReference(profile, setpoint, dt_s, left, control);
  if (!compliant) {
    control.integral += error * dt_s;
    if (control.i > 0) {
      const double most = joint.max_velocity / control.i;
      control.integral = std::clamp(control.integral, -most, most);
    }
    const double velocity = rate + std::min(control.p, 1 / dt_s) * error + control.i * control.integral +
                            control.d * (rate - place.velocity);
    return VelocityRow(joint, place, stop, velocity, dt_s);
  }
  const double effort = control.stiffness * (control.reference - place.position) + control.offset;
  const double resistance = control.damping + dt_s * control.stiffness;
  if (stop != 0 || resistance <= 0) return EffortRow(joint, place, stop, effort, dt_s);
  JointRow row{(effort + place.load) / resistance, joint.max_effort, 1 / resistance};
  row.stiffness = control.stiffness;
  row.damping = control.damping;
  return row;
}

double LimitedEffort(double most, const Setpoint& limiter) {
  return limiter.mode == ControlMode::kDirect ? std::clamp(limiter.reference, 0.0, most) : most;
}

bool IsUnderWay(const Setpoint& setpoint, const JointControl& control) {
  return setpoint.mode == ControlMode::kPosition && control.reference != control.target;
}

}  // namespace coopdyn
