// SPDX-License-Identifier: MIT
// The muscles and thrusters of an island with limbs.
#include <algorithm>

#include "server/physics/limb_solver.h"

namespace coopdyn {

LimbSolver::Pull LimbSolver::PullOf(const Member& member, int joint) const {
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  const Hinge hinge = HingeOf(member, joint);
  Pull pull;
  pull.from = hinge.parent;
  pull.to = hinge.child;
  pull.p_from_W = forest_.Point(hinge.parent, model.muscle->p_from_R);
  pull.p_to_W = forest_.Point(hinge.child, model.muscle->p_to_R);
  const Vector3 way = pull.p_to_W - pull.p_from_W;
  pull.length_m = way.norm();
  constexpr double kNothing_m = 1e-9;
  pull.direction_W = pull.length_m > kNothing_m ? Vector3(way / pull.length_m) : Vector3(Vector3::Zero());
  return pull;
}

// F(u) of the shortening speed u falls: its tangent at the speed of now is a row, u + softness · impulse =
// target, so that the muscle damps at the end of the step.
void LimbSolver::AddMuscle(const Member& member, int joint, double dt_s) {
  const Joint& of = member.mechanism->joints[static_cast<std::size_t>(joint)];
  const MuscleModel& muscle = *of.model->muscle;
  if (of.channel < 0) return;
  const Setpoint& wanted = member.channels[static_cast<std::size_t>(of.channel)].setpoint;
  const double activation = wanted.mode == ControlMode::kPwm ? std::clamp(wanted.reference, 0.0, 1.0) : 0;
  const Pull pull = PullOf(member, joint);
  const double most_n = activation * muscle.max_force_n * LengthFactor(muscle, pull.length_m);
  if (!(most_n > 0) || pull.direction_W.isZero(0)) return;
  const Vector3 none = Vector3::Zero();
  Row& row = rows_.emplace_back();
  row.effort = static_cast<int>(member.first_effort + static_cast<std::size_t>(joint));
  AddWrench(pull.to, pull.p_to_W, none, -pull.direction_W, row);
  AddWrench(pull.from, pull.p_from_W, none, pull.direction_W, row);
  row.softness = kRigid;
  row.lower = row.upper = most_n * dt_s;
  if (!muscle.use_velocity) return;
  const double fastest = muscle.max_velocity_m_s;
  const double speed_m_s = std::clamp(RateOf(row, forest_.rates()), -fastest, fastest);
  const VelocityFactor factor = VelocityFactorOf(muscle, speed_m_s);
  row.lower = 0;
  row.upper = most_n * muscle.eccentric * dt_s;
  if (factor.slope < 0) {
    row.target = speed_m_s - factor.value / factor.slope;
    row.softness = -1 / (most_n * factor.slope * dt_s) + kRigid;
  }
}

// Its impulse is given: no row needs it.
void LimbSolver::Thrust(const Member& member, int joint, double dt_s) {
  const Joint& of = member.mechanism->joints[static_cast<std::size_t>(joint)];
  const JointModel& model = *of.model;
  if (of.channel < 0) return;
  const Setpoint& wanted = member.channels[static_cast<std::size_t>(of.channel)].setpoint;
  if (wanted.mode != ControlMode::kEffort || wanted.reference == 0) return;
  const double effort = std::clamp(wanted.reference, -model.max_effort, model.max_effort);
  const int node = HingeOf(member, joint).child;
  const Vector3 none = Vector3::Zero(), wrench = forest_.Axis(node, model.axis_R) * (effort * dt_s);
  const bool pushes = model.kind == JointModel::Kind::kForce;
  Row row;
  const std::size_t before = jacobian_.size();
  AddWrench(node, forest_.Point(node, model.p_RJ), pushes ? none : wrench, pushes ? wrench : none, row);
  for (const Row::Part& part : row.all()) {
    const double* impulse = jacobian_.data() + part.from;
    for (const int dof : forest_.Chain(part.end)) pushes_[static_cast<std::size_t>(dof)] += *impulse++;
  }
  jacobian_.resize(before);
  efforts_[member.first_effort + static_cast<std::size_t>(joint)] += effort;
}

}  // namespace coopdyn
