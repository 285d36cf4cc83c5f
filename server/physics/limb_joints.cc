// SPDX-License-Identifier: MIT
// Forces on the joints of an island with limbs: motors, springs, friction, stops, loops, couplings, muscles,
// thrusters.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/model/drive.h"
#include "server/physics/drive_train.h"
#include "server/physics/limb_solver.h"

namespace coopdyn {

namespace {

using Kind = JointModel::Kind;

constexpr double kSaturated = 1 - 1e-9;

}  // namespace

LimbSolver::Hinge LimbSolver::HingeOf(const Member& member, int joint) const {
  const LimbTree& tree = member.mechanism->tree;
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  const int child = tree.node_of[static_cast<std::size_t>(model.child)];
  const int parent = tree.node_of[static_cast<std::size_t>(model.parent)];
  Hinge hinge;
  hinge.child = member.first_node + child;
  hinge.parent = member.first_node + parent;
  if (tree.nodes[static_cast<std::size_t>(child)].joint == joint) hinge.node = hinge.child;
  if (tree.nodes[static_cast<std::size_t>(parent)].joint == joint) hinge.node = hinge.parent;
  return hinge;
}

void LimbSolver::AddRate(const Member& member, int joint, double scale, Row& row) {
  const Hinge hinge = HingeOf(member, joint);
  if (hinge.node != kNone) {
    const int dof = forest_.FirstDof(hinge.node);
    row.parts[row.part_count++] = {dof, jacobian_.size()};
    jacobian_.resize(jacobian_.size() + static_cast<std::size_t>(forest_.ChainLength(dof)));
    jacobian_.back() = scale;
    return;
  }
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  const Vector3 none = Vector3::Zero(), axis_W = forest_.Axis(hinge.parent, model.axis_R) * scale;
  const Vector3 p_W = forest_.Point(hinge.child, model.p_RJ);
  const bool slides = model.kind == Kind::kSlider;
  const Vector3 &torque = slides ? none : axis_W, &force = slides ? axis_W : none;
  AddWrench(hinge.child, p_W, torque, force, row);
  AddWrench(hinge.parent, p_W, -torque, -force, row);
}

double LimbSolver::PositionOf(const Member& member, int joint) const {
  const Hinge hinge = HingeOf(member, joint);
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  if (hinge.node != kNone) return model.start + forest_.Position(hinge.node);
  if (model.muscle) return PullOf(member, joint).length_m;
  if (model.kind == Kind::kSlider) {
    const Vector3 way = forest_.Point(hinge.child, model.p_RJ) - forest_.Point(hinge.parent, model.p_RJ);
    return model.start + way.dot(forest_.Axis(hinge.parent, model.axis_R));
  }
  return model.start + AngleAbout(forest_.Between(hinge.parent, hinge.child), model.axis_R);
}

void LimbSolver::AddMotor(const Member& member, int joint, double target, double softness, double lower,
                          double upper, bool counts, const Resistance& resistance) {
  const Hinge hinge = HingeOf(member, joint);
  const std::size_t effort = counts ? member.first_effort + static_cast<std::size_t>(joint) : kNowhere;
  if (hinge.node != kNone) {
    motors_.push_back(
        {forest_.FirstDof(hinge.node), effort, target, softness + kRigid, lower, upper, resistance});
    return;
  }
  Row& row = rows_.emplace_back();
  row.target = target;
  row.resistance = resistance;
  row.softness = softness + kRigid;
  row.lower = lower;
  row.upper = upper;
  if (counts) row.effort = static_cast<int>(effort);
  AddRate(member, joint, 1, row);
}

void LimbSolver::DriveByTrain(const Member& member, int joint, std::span<const CouplingShare> shares,
                              double dt_s) {
  const Joint& of = member.mechanism->joints[static_cast<std::size_t>(joint)];
  const Hinge hinge = HingeOf(member, joint);
  const std::size_t first = motors_.size();
  for (const CouplingShare& share : shares) {
    AddMotor(member, joint, share.target, share.softness / dt_s, share.lower * dt_s, share.upper * dt_s);
  }
  double rate = 0;
  if (hinge.node != kNone) rate = forest_.rates()[static_cast<std::size_t>(forest_.FirstDof(hinge.node))];
  // Warm start from the present rate, so that the two faces of a gap do not both hold.
  for (std::size_t i = first; i < motors_.size(); ++i) {
    Motor& motor = motors_[i];
    const double missing = motor.target - rate;
    if (missing > motor.softness * motor.upper) motor.saturated_side = 1;
    if (missing < motor.softness * motor.lower) motor.saturated_side = -1;
  }
  Resist(member, joint, FrictionOf(*of.model->drive_train, rate), false, dt_s);
}

void LimbSolver::Resist(const Member& member, int joint, double friction, bool counts, double dt_s) {
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  const double position = PositionOf(member, joint);
  const double resistance = model.damping + dt_s * model.stiffness;
  if (resistance > 0) {
    const double spring = -model.stiffness * (position - model.rest);
    AddMotor(member, joint, spring / resistance, 1 / (resistance * dt_s), -kInfinity, kInfinity, counts,
             {model.stiffness, model.damping});
  }
  if (friction > 0) AddMotor(member, joint, 0, 0, -friction * dt_s, friction * dt_s, counts);
  AddStops(member, joint, position, dt_s);
}

void LimbSolver::AddStops(const Member& member, int joint, double position, double dt_s) {
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  // Fast enough that no impact passes a stop within a substep.
  constexpr double kNear_rad_s = 10;
  if (position - model.lower < kNear_rad_s * dt_s) AddStop(member, joint, -1, position - model.lower, dt_s);
  if (model.upper - position < kNear_rad_s * dt_s) AddStop(member, joint, 1, model.upper - position, dt_s);
}

// `gap`: distance to the stop; negative: beyond it. A stop pushes out slowly, so nothing bounces.
void LimbSolver::AddStop(const Member& member, int joint, int side, double gap, double dt_s) {
  Row& row = rows_.emplace_back();
  const double back = gap >= 0 ? -gap / dt_s : std::min(kErp * -gap / dt_s, kMaxPushOut_m_s);
  row.target = -side * back;
  row.softness = kRigid;
  (side < 0 ? row.lower : row.upper) = 0;
  AddRate(member, joint, 1, row);
}

void LimbSolver::Push(const Member& member, int joint, double impulse) {
  const Hinge hinge = HingeOf(member, joint);
  if (hinge.node != kNone) {
    pushes_[static_cast<std::size_t>(forest_.FirstDof(hinge.node))] += impulse;
    return;
  }
  Row& row = rows_.emplace_back();  // a row with a given impulse
  row.lower = row.upper = impulse;
  row.softness = kRigid;
  AddRate(member, joint, 1, row);
}

void LimbSolver::DriveJoints(const Member& member, std::span<const JointRow> rows, double dt_s) {
  const Mechanism& mechanism = *member.mechanism;
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i) {
    const Joint& joint = mechanism.joints[i];
    const JointModel& model = *joint.model;
    const int index = static_cast<int>(i);
    if (model.limits >= 0) continue;
    if (model.muscle) {
      AddMuscle(member, index, dt_s);
    } else if (model.thrusts()) {
      Thrust(member, index, dt_s);
    } else if (joint.control >= 0) {
      const JointRow& row = rows[static_cast<std::size_t>(joint.control)];
      const ControlMode mode = member.channels[static_cast<std::size_t>(joint.channel)].setpoint.mode;
      holds_ |= !row.shares.empty() || row.stiffness > 0 || mode == ControlMode::kPosition ||
                mode == ControlMode::kDirect || mode == ControlMode::kVelocity;
      if (!row.shares.empty()) {
        DriveByTrain(member, index, row.shares, dt_s);
      } else if (row.stop != 0 && !flies_) {
        AddStop(member, index, row.stop, row.gap, dt_s);
      } else if (row.max_effort > 0) {
        const std::size_t first = motors_.size();
        AddMotor(member, index, row.velocity, row.softness / dt_s, -row.max_effort * dt_s,
                 row.max_effort * dt_s, true, {row.stiffness, row.damping});
        // Warm start: saturated motors start saturated.
        const double effort = member.channels[static_cast<std::size_t>(joint.channel)].effort;
        if (motors_.size() > first && std::abs(effort) > kSaturated * row.max_effort)
          motors_.back().saturated_side = effort > 0 ? 1 : -1;
      }
      if (row.friction > 0) AddMotor(member, index, 0, 0, -row.friction * dt_s, row.friction * dt_s, true);
      // In a part of a step, row.stop is out of date.
      if (flies_) {
        const double last = member.channels[static_cast<std::size_t>(joint.channel)].position;
        AddStops(member, index, PositionNear(member, index, last), dt_s);
      }
      if (row.effort != 0) {
        Push(member, index, row.effort * dt_s);
        efforts_[member.first_effort + i] += dt_s / step_s_ * row.effort;
      }
    } else if (joint.channel >= 0) {
      const Setpoint& wanted = member.channels[static_cast<std::size_t>(joint.channel)].setpoint;
      double most = joint.max_effort;
      if (joint.limiter >= 0)
        most = LimitedEffort(most, member.channels[static_cast<std::size_t>(joint.limiter)].setpoint);
      AddMotor(member, index, wanted.reference, 0, most * dt_s);
    } else if (model.has_axis() && (model.is_resisted() || model.has_stop() || joint.steers >= 0)) {
      if (joint.steers >= 0) Steer(member, index, dt_s);
      holds_ |= joint.steers >= 0;
      Resist(member, index, model.friction, true, dt_s);
    }
  }
}

// Turns a front wheel to the angle that the driven wheels' set-points imply.
void LimbSolver::Steer(const Member& member, int joint, double dt_s) {
  const RobotModel& robot = *member.mechanism->model;
  const Joint& of = member.mechanism->joints[static_cast<std::size_t>(joint)];
  const ChannelState* const wheels = &member.channels[robot.FirstChannel(*robot.drive_actuator())];
  const std::array<double, 2> wanted_rad =
      SteeringAngles(*robot.drive(), {wheels[0].setpoint.reference, wheels[1].setpoint.reference});
  const double way_rad = wanted_rad[static_cast<std::size_t>(of.steers)] - PositionOf(member, joint);
  const double most_rad_s = of.model->max_velocity;
  AddMotor(member, joint, std::clamp(way_rad / dt_s, -most_rad_s, most_rad_s), 0,
           of.model->max_effort * dt_s);
}

void LimbSolver::CloseLoop(const Member& member, int joint, double dt_s) {
  const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
  const Hinge hinge = HingeOf(member, joint);
  const Vector3 none = Vector3::Zero();
  const Vector3 p = forest_.Point(hinge.child, model.p_RJ);
  const Vector3 apart = p - forest_.Point(hinge.parent, model.p_RJ);
  const Vector3 axis = forest_.Axis(hinge.parent, model.axis_R);
  const Vector3 across = axis.unitOrthogonal(), third = axis.cross(across);
  const auto hold = [&](const Vector3& torque, const Vector3& force, double error) {
    Row& row = rows_.emplace_back();
    row.target = -kErp / dt_s * error;
    row.softness = kRigid;
    AddWrench(hinge.child, p, torque, force, row);
    AddWrench(hinge.parent, p, -torque, -force, row);
  };
  const auto hold_point = [&](const Vector3& along) { hold(none, along, apart.dot(along)); };
  hold_point(across);
  hold_point(third);
  if (model.kind == Kind::kScrew) {
    hold(-model.pitch_m_rad * axis, axis, 0);
  } else if (model.kind != Kind::kSlider) {
    hold_point(axis);
  }
  switch (model.kind) {
    case Kind::kBall:
      break;
    case Kind::kUniversal: {
      const Vector3 second = forest_.Axis(hinge.child, model.axis2_R);
      hold(second.cross(axis), none, axis.dot(second) - model.axis_R.dot(model.axis2_R));
      break;
    }
    case Kind::kSlider: {
      const Quaternion q = forest_.Between(hinge.parent, hinge.child);
      const Vector3 turned = forest_.Axis(hinge.parent, std::copysign(2, q.w()) * q.vec());
      for (const Vector3& along : {axis, across, third}) hold(along, none, turned.dot(along));
      break;
    }
    default: {
      const Vector3 turned = axis.cross(forest_.Axis(hinge.child, model.axis_R));
      for (const Vector3& along : {across, third}) hold(along, none, turned.dot(along));
      break;
    }
  }
}

// Couples the rates exactly. Corrects the positions only if neither joint can wrap.
void LimbSolver::Couple(const Member& member, double dt_s) {
  if (member.mechanism->model == nullptr) return;
  const auto wraps = [&](int joint) {
    const JointModel& model = *member.mechanism->joints[static_cast<std::size_t>(joint)].model;
    constexpr double kTurn_rad = std::numbers::pi;
    return model.kind == Kind::kHinge && (model.lower < -kTurn_rad || model.upper > kTurn_rad);
  };
  for (const CouplingModel& of : member.mechanism->model->couplings) {
    Row& row = rows_.emplace_back();
    row.softness = kRigid;
    if (!wraps(of.follower) && !wraps(of.leader)) {
      const double error =
          PositionOf(member, of.follower) - of.multiplier * PositionOf(member, of.leader) - of.offset;
      row.target = -kErp / dt_s * error;
    }
    AddRate(member, of.follower, 1, row);
    AddRate(member, of.leader, -of.multiplier, row);
  }
}

double LimbSolver::JointRate(std::uint32_t thing, std::size_t joint) const {
  const Member& member = members_[static_cast<std::size_t>(member_of_[thing])];
  if (member.mechanism->joints[joint].model->limits >= 0) return 0;
  const Hinge hinge = HingeOf(member, static_cast<int>(joint));
  if (hinge.node != kNone) return rates_[static_cast<std::size_t>(forest_.FirstDof(hinge.node))];
  const JointModel& model = *member.mechanism->joints[joint].model;
  const BodyState &child = forest_.body(hinge.child), &parent = forest_.body(hinge.parent);
  if (model.muscle) {
    const Pull pull = PullOf(member, static_cast<int>(joint));
    const auto velocity = [](const BodyState& body, const Vector3& p_W) -> Vector3 {
      return body.v_WB + body.w_WB.cross(p_W - body.p_WB);
    };
    return pull.direction_W.dot(velocity(child, pull.p_to_W) - velocity(parent, pull.p_from_W));
  }
  const Vector3 axis = forest_.Axis(hinge.parent, model.axis_R);
  if (model.kind == Kind::kTorque) return axis.dot(child.w_WB);
  if (model.kind == Kind::kForce) {
    const Vector3 p = forest_.Point(hinge.child, model.p_RJ);
    return axis.dot(child.v_WB + child.w_WB.cross(p - child.p_WB));
  }
  if (model.kind != Kind::kSlider) return axis.dot(child.w_WB - parent.w_WB);
  const Vector3 p = forest_.Point(hinge.child, model.p_RJ);
  const Vector3 of_child = child.v_WB + child.w_WB.cross(p - child.p_WB);
  return axis.dot(of_child - parent.v_WB - parent.w_WB.cross(p - parent.p_WB));
}

double LimbSolver::JointPosition(std::uint32_t thing, std::size_t joint, double last) const {
  return PositionNear(members_[static_cast<std::size_t>(member_of_[thing])], static_cast<int>(joint), last);
}

double LimbSolver::PositionNear(const Member& member, int joint, double last) const {
  const double position = PositionOf(member, joint);
  const Kind kind = member.mechanism->joints[static_cast<std::size_t>(joint)].model->kind;
  if (kind != Kind::kHinge) return position;
  return last + std::remainder(position - last, 2 * std::numbers::pi);
}

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

// The force F(u) decreases with the shortening speed u. Its tangent at the present speed is a row, u +
// softness · impulse = target, so that the muscle damps with the rate of the step's end.
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

// The impulse is given, so it needs no row.
void LimbSolver::Thrust(const Member& member, int joint, double dt_s) {
  const Joint& of = member.mechanism->joints[static_cast<std::size_t>(joint)];
  const JointModel& model = *of.model;
  if (of.channel < 0) return;
  const Setpoint& wanted = member.channels[static_cast<std::size_t>(of.channel)].setpoint;
  if (wanted.mode != ControlMode::kEffort || wanted.reference == 0) return;
  const double effort = std::clamp(wanted.reference, -model.max_effort, model.max_effort);
  const int node = HingeOf(member, joint).child;
  const Vector3 wrench = forest_.Axis(node, model.axis_R) * (effort * dt_s);
  const bool pushes = model.kind == JointModel::Kind::kForce;
  const Vector3 force = pushes ? wrench : Vector3::Zero(),
                torque = pushes ? model.torque_per_force_m * wrench : wrench;
  Row row;
  const std::size_t before = jacobian_.size();
  AddWrench(node, forest_.Point(node, model.p_RJ), torque, force, row);
  for (const Row::Part& part : row.all()) {
    const double* impulse = jacobian_.data() + part.from;
    for (const int dof : forest_.Chain(part.end)) pushes_[static_cast<std::size_t>(dof)] += *impulse++;
  }
  jacobian_.resize(before);
  efforts_[member.first_effort + static_cast<std::size_t>(joint)] += dt_s / step_s_ * effort;
}

}  // namespace coopdyn
