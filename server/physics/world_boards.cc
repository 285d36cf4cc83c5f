// SPDX-License-Identifier: MIT
// The world's control boards: their set-points, and what their joints' motors do in a substep.
#include <algorithm>
#include <cmath>

#include "server/physics/rest.h"
#include "server/physics/world.h"

namespace coopdyn {

namespace {

/// A joint's axis and anchor in the world, carried by its child, and its rate.
struct JointMotion {
  Vector3 axis_W, anchor_W;
  double rate = 0;
};
JointMotion MotionOf(const JointModel& joint, std::span<const RigidBody> rigid, const BodyState* bodies) {
  if (joint.muscle || joint.limits >= 0)
    return {Vector3::Zero(), Vector3::Zero(), 0};  // no motor works on its axis
  const auto child = static_cast<std::size_t>(joint.child), parent = static_cast<std::size_t>(joint.parent);
  const Quaternion R_WR = bodies[child].orientation() * rigid[child].X_RB.q.conjugate();
  JointMotion motion;
  motion.axis_W = R_WR * joint.axis_R;
  motion.anchor_W = bodies[child].p_WB + R_WR * (joint.p_RJ - rigid[child].X_RB.p);
  const auto velocity_at = [&](const BodyState& body) -> Vector3 {
    return body.v_WB + body.w_WB.cross(motion.anchor_W - body.p_WB);
  };
  if (joint.thrusts()) {
    motion.rate = motion.axis_W.dot(joint.slides() ? velocity_at(bodies[child]) : bodies[child].w_WB);
    return motion;
  }
  const bool slides = joint.kind == JointModel::Kind::kSlider;
  motion.rate = motion.axis_W.dot(slides ? Vector3(velocity_at(bodies[child]) - velocity_at(bodies[parent]))
                                         : Vector3(bodies[child].w_WB - bodies[parent].w_WB));
  return motion;
}

}  // namespace

void PhysicsWorld::FitBoards() {
  board_joints_.clear();
  for (std::size_t i = things_.first_robot; i < things_.first_static; ++i) {
    const Thing& thing = things_.all[i];
    if (thing.control_count == 0) continue;
    board_joints_.resize(thing.first_control + thing.control_count);
    for (const Joint& joint : thing.mechanism->joints) {
      if (joint.control < 0) continue;
      const std::size_t channel = thing.first_channel + static_cast<std::size_t>(joint.channel);
      board_joints_[thing.first_control + static_cast<std::size_t>(joint.control)] = {
          static_cast<std::uint32_t>(i), channel, &joint, scene_->channels[channel].drive_train};
    }
  }
  board_trains_.assign(static_cast<std::size_t>(scene_->drive_train_count), {});
  for (const BoardJoint& of : board_joints_) {
    if (of.drive_train < 0) continue;
    JointModel& motor = board_trains_[static_cast<std::size_t>(of.drive_train)].motor;
    motor = *of.joint->model;
    motor.lower = -JointModel::kInfinity;
    motor.upper = JointModel::kInfinity;
    motor.damping = motor.friction = motor.stiffness = 0;
  }
  rows_.resize(board_joints_.size());
}

std::vector<double> PhysicsWorld::RatesOf(std::uint32_t thing) const {
  std::vector<double> rates;
  const Mechanism& mechanism = *things_.all[thing].mechanism;
  if (!measures_.MeasuresWork(thing) || mechanism.one_body()) return rates;
  for (const Joint& joint : mechanism.joints)
    rates.push_back(MotionOf(*joint.model, mechanism.bodies, &FirstBody(thing)).rate);
  return rates;
}

JointPlace PhysicsWorld::PlaceOf(std::size_t control) const {
  const BoardJoint& of = board_joints_[control];
  const JointModel& model = *of.joint->model;
  const std::vector<RigidBody>& rigid = things_.all[of.thing].mechanism->bodies;
  const BodyState* const bodies = &FirstBody(of.thing);
  const JointMotion motion = MotionOf(model, rigid, bodies);
  const Vector3 &axis_W = motion.axis_W, &anchor_W = motion.anchor_W;
  const bool slides = model.kind == JointModel::Kind::kSlider;
  JointPlace place;
  place.position = channels_[of.channel].position;
  place.velocity = motion.rate;
  if (!of.joint->board->gravity_compensation) return place;
  for (const int body : of.joint->beyond) {
    const auto index = static_cast<std::size_t>(body);
    const Vector3 weight_N = rigid[index].mass_kg * scene_->scenario->simulation.g_W;
    const Vector3 arm_m = bodies[index].p_WB - anchor_W;
    place.load -= axis_W.dot(slides ? weight_N : Vector3(arm_m.cross(weight_N)));
  }
  return place;
}

double PhysicsWorld::InertiaBeyond(std::size_t control) const {
  const BoardJoint& of = board_joints_[control];
  const std::vector<RigidBody>& rigid = things_.all[of.thing].mechanism->bodies;
  const BodyState* const bodies = &FirstBody(of.thing);
  const JointMotion motion = MotionOf(*of.joint->model, rigid, bodies);
  double inertia_kg_m2 = 0;
  for (const int body : of.joint->beyond) {
    const auto index = static_cast<std::size_t>(body);
    const Vector3 axis_B = bodies[index].orientation().conjugate() * motion.axis_W;
    inertia_kg_m2 +=
        axis_B.dot(rigid[index].inertia_kg_m2 * axis_B) +
        rigid[index].mass_kg * motion.axis_W.cross(bodies[index].p_WB - motion.anchor_W).squaredNorm();
  }
  return inertia_kg_m2;
}

JointPlace PhysicsWorld::MotorPlaceOf(std::size_t control) const {
  JointPlace place = PlaceOf(control);
  const int train = board_joints_[control].drive_train;
  if (train < 0) return place;
  place.position = drive_trains_[static_cast<std::size_t>(train)].rotor_rad;
  place.velocity = drive_trains_[static_cast<std::size_t>(train)].rotor_rad_s;
  return place;
}

const JointModel& PhysicsWorld::MotorOf(std::size_t control) const {
  const BoardJoint& of = board_joints_[control];
  return of.drive_train < 0 ? *of.joint->model
                            : board_trains_[static_cast<std::size_t>(of.drive_train)].motor;
}

void PhysicsWorld::FinishTrain(std::size_t control, double effort, double dt_s) {
  const BoardJoint& of = board_joints_[control];
  if (of.drive_train < 0) return;
  const auto train = static_cast<std::size_t>(of.drive_train);
  AdvanceTrain(*of.joint->model->drive_train, board_trains_[train].step, effort, dt_s, drive_trains_[train]);
}

bool PhysicsWorld::RotorsRest(const Thing& thing) const {
  constexpr double kSlow_rad_s = 0.01;
  for (std::size_t i = 0; !board_trains_.empty() && i < thing.control_count; ++i) {
    const int train = board_joints_[thing.first_control + i].drive_train;
    if (train >= 0 && std::abs(drive_trains_[static_cast<std::size_t>(train)].rotor_rad_s) > kSlow_rad_s)
      return false;
  }
  return true;
}

void PhysicsWorld::TakeSetpoints(std::span<const Setpoint> setpoints) {
  const std::size_t given = std::min(channels_.size(), setpoints.size());
  const auto next = [&](std::size_t channel) { return channel < given ? setpoints[channel] : Setpoint(); };
  for (std::size_t i = 0; i < board_joints_.size(); ++i) {
    const BoardJoint& of = board_joints_[i];
    const Setpoint& last = channels_[of.channel].setpoint;
    if (next(of.channel) == last) continue;
    Plan(*of.joint->model, of.joint->board->profile, MotorPlaceOf(i), last, next(of.channel), controls_[i]);
    for (BodyState& body : BodiesOf(of.thing)) {
      if (body.sleep_counter <= kAsleep) body.sleep_counter = 0;
    }
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    channels_[i].setpoint = next(i);
    channels_[i].velocity = 0;
  }
}

void PhysicsWorld::AdvanceBoards(double dt_s, int left) {
  for (std::size_t i = 0; i < board_joints_.size(); ++i) {
    const BoardJoint& of = board_joints_[i];
    if (FirstBody(of.thing).frozen()) continue;
    const Setpoint& setpoint = channels_[of.channel].setpoint;
    rows_[i] =
        Advance(MotorOf(i), of.joint->board->profile, MotorPlaceOf(i), setpoint, dt_s, left, controls_[i]);
    if (of.joint->limiter >= 0) {
      const std::size_t limiter =
          things_.all[of.thing].first_channel + static_cast<std::size_t>(of.joint->limiter);
      rows_[i].max_effort = LimitedEffort(rows_[i].max_effort, channels_[limiter].setpoint);
    }
    if (of.drive_train < 0) continue;
    const auto train = static_cast<std::size_t>(of.drive_train);
    const DriveTrainModel& model = *of.joint->model->drive_train;
    TrainStep& step = board_trains_[train].step;
    step.law = LawOf(model, setpoint, rows_[i]);
    PlanTrain(model, drive_trains_[train], PlaceOf(i), InertiaBeyond(i), dt_s, step);
    rows_[i].shares = step.shares;
  }
}

bool PhysicsWorld::IsUnderWay(const Thing& thing) const {
  for (std::size_t i = thing.first_control; i < thing.first_control + thing.control_count; ++i) {
    if (coopdyn::IsUnderWay(channels_[board_joints_[i].channel].setpoint, controls_[i])) return true;
  }
  return false;
}

void PhysicsWorld::Tune(std::size_t control, const JointControl& tuned) {
  controls_[control] = tuned;
  for (BodyState& body : BodiesOf(board_joints_[control].thing)) {
    if (body.sleep_counter <= kAsleep) body.sleep_counter = 0;
  }
}

}  // namespace coopdyn
