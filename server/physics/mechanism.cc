// SPDX-License-Identifier: MIT
// Makes the mechanisms of robots and objects.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"
#include "server/physics/things.h"

namespace coopdyn {

namespace {

Pose PlaceInR(const LinkModel& link, const LinkShape& collision) {
  return link.X_RL * collision.X_LG;
}

Matrix3 Turned(const Vector3& moments, const Matrix3& R) {
  const Matrix3 I = R * moments.asDiagonal() * R.transpose();
  return (I + I.transpose()) / 2;
}

Part MakePart(const RobotModel& model, std::size_t link, const LinkShape& collision) {
  Part part{collision.shape};
  part.link = static_cast<int>(link);
  part.collision = collision.piece_of >= 0
                       ? collision.piece_of
                       : static_cast<int>(&collision - model.links[link].collisions.data());
  part.friction = collision.friction;
  part.restitution = collision.restitution;
  part.friction_along_G = collision.friction_along_G;
  part.friction_across = collision.friction_across;
  part.rolling_friction_m = collision.rolling_friction_m;
  part.spinning_friction_m = collision.spinning_friction_m;
  part.contact_stiffness_n_m = collision.contact_stiffness_n_m;
  part.contact_damping_n_s_m = collision.contact_damping_n_s_m;
  part.wheel = WheelOf(model, static_cast<int>(link), collision);
  return part;
}

/// Welds all links into one body.
void AddOneBody(Mechanism& robot) {
  const RobotModel& model = *robot.model;
  RigidBody body;
  body.X_RB.p = CenterOfMass(model);
  body.inertia_kg_m2.setZero();
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    const LinkModel& link = model.links[k];
    const Pose X_RI = link.X_RL * link.X_LI;
    const Vector3 d = X_RI.p - body.X_RB.p;
    body.mass_kg += link.mass_kg;
    body.inertia_kg_m2 += Turned(link.inertia_kg_m2, X_RI.q.toRotationMatrix()) +
                          link.mass_kg * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
    for (const LinkShape& collision : link.collisions) {
      const Pose X_RG = PlaceInR(link, collision);
      Part part = MakePart(model, k, collision);
      part.p_BG = X_RG.p - body.X_RB.p;
      part.R_BG = X_RG.q.toRotationMatrix();
      robot.parts.push_back(part);
    }
  }
  robot.bodies = {body};
}

/// The bodies that joint `index` moves: all that other joints connect to its child.
std::vector<int> BodiesBeyond(const RobotModel& model, std::size_t index) {
  std::vector<int> beyond{model.joints[index].child};
  const auto add = [&](int from, int body, int next) {
    if (from == body && next != model.joints[index].parent && !std::ranges::count(beyond, next))
      beyond.push_back(next);
  };
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
      if (j == index || !model.joints[j].joins()) continue;
      const int body = beyond[k];
      add(model.joints[j].parent, body, model.joints[j].child);
      add(model.joints[j].child, body, model.joints[j].parent);
    }
  }
  return beyond;
}

/// Sets the motor of joint `j` of the model.
void AddMotor(const RobotModel& model, std::size_t j, Joint& joint) {
  int channel = 0, control = 0;
  for (const ActuatorModel& actuator : model.actuators) {
    const auto* board = std::get_if<BoardModel>(&actuator.kind);
    const auto* drive = std::get_if<DriveModel>(&actuator.kind);
    for (int side = 0; drive != nullptr && drive->steering && side < 2; ++side) {
      if (drive->steering->joints[static_cast<std::size_t>(side)] == static_cast<int>(j)) joint.steers = side;
    }
    for (const int driven : actuator.joints) {
      if (driven == static_cast<int>(j)) {
        joint.channel = channel;
        joint.max_effort = drive != nullptr ? drive->max_torque_nm : model.joints[j].max_effort;
        joint.board = board;
        if (board != nullptr) joint.control = control;
        const auto& train = model.joints[j].drive_train;
        if (board != nullptr && (board->gravity_compensation || (train && !train->is_rigid())))
          joint.beyond = BodiesBeyond(model, j);
      }
      ++channel;
      if (board != nullptr) ++control;
    }
  }
}

/// Makes each link a body.
void AddLinks(Mechanism& robot) {
  const RobotModel& model = *robot.model;
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    const LinkModel& link = model.links[k];
    robot.bodies.push_back({link.mass_kg, link.inertia_kg_m2.asDiagonal(), link.X_RL * link.X_LI});
    for (const LinkShape& collision : link.collisions) {
      const Pose X_IG = link.X_LI.Inverse() * collision.X_LG;
      Part part = MakePart(model, k, collision);
      part.body = static_cast<int>(k);
      part.p_BG = X_IG.p;
      part.R_BG = X_IG.q.toRotationMatrix();
      robot.parts.push_back(part);
    }
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    Joint joint;
    joint.model = &model.joints[j];
    AddMotor(model, j, joint);
    robot.joint_rows += 6;
    robot.joints.push_back(joint);
  }
  for (const Joint& joint : robot.joints) {
    if (joint.model->limits >= 0)
      robot.joints[static_cast<std::size_t>(joint.model->limits)].limiter = joint.channel;
  }
  robot.fixed_base = model.fixed_base;
  if (model.has_limbs()) robot.limb_radii_m.resize(robot.bodies.size());
}

/// Places friction grains that belong to another link than their part.
void PlaceGrains(Mechanism& robot) {
  for (Part& part : robot.parts) {
    const LinkShape& collision = robot.model->links[static_cast<std::size_t>(part.link)]
                                     .collisions[static_cast<std::size_t>(part.collision)];
    if (collision.friction_frame < 0) continue;
    const FrameModel& frame = robot.model->frames[static_cast<std::size_t>(collision.friction_frame)];
    part.friction_body = robot.one_body() ? 0 : frame.link;
    const Quaternion q_BR = robot.bodies[static_cast<std::size_t>(part.friction_body)].X_RB.q.conjugate();
    part.friction_along_G = q_BR * (frame.X_RF.q * collision.friction_along_G);
  }
}

LimbTree TreeOf(const Mechanism& mechanism) {
  std::vector<JointModel> joints;
  std::vector<bool> is_driven;
  for (const Joint& joint : mechanism.joints) {
    joints.push_back(*joint.model);
    is_driven.push_back(joint.channel >= 0);
  }
  return MakeLimbTree(mechanism.bodies.size(), joints, is_driven, mechanism.fixed_base);
}

/// A part, placed with its robot at the origin.
PlacedPart AtOrigin(const Mechanism& robot, const Part& part) {
  const Pose& X_RB = robot.bodies[static_cast<std::size_t>(part.body)].X_RB;
  BodyState body;
  body.p_WB = X_RB.p;
  const Matrix3 R = X_RB.q.toRotationMatrix();
  for (int i = 0; i < 9; ++i) body.R_WB[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
  PlacedPart placed(part, body);
  placed.half_m = HalfExtents(part.shape, Matrix3(R * part.R_BG));
  return placed;
}

/// Radius about R's z axis of the vertical cylinder that contains a part.
double RadiusOf(const PlacedPart& placed) {
  const double x = placed.p[0], y = placed.p[1];
  const bool round =
      std::holds_alternative<Sphere>(placed.part->shape) ||
      (std::holds_alternative<Cylinder>(placed.part->shape) && std::abs(placed.R[10]) > 1 - 1e-9);
  if (round) return portable::Hypot(x, y) + placed.half_m.x();
  return portable::Hypot(std::abs(x) + placed.half_m.x(), std::abs(y) + placed.half_m.y());
}

void Measure(Mechanism& robot) {
  for (const Part& part : robot.parts) {
    const PlacedPart placed = AtOrigin(robot, part);
    robot.radius_m = std::max(robot.radius_m, RadiusOf(placed));
    robot.reach_m = std::max(robot.reach_m, placed.place().position().norm() + BoundingRadius(part.shape));
    robot.height_m = std::max(robot.height_m, placed.p[2] + placed.half_m.z());
    robot.lowest_m = std::min(robot.lowest_m, placed.p[2] - placed.half_m.z());
    if (!robot.limb_radii_m.empty()) {
      double& radius_m = robot.limb_radii_m[static_cast<std::size_t>(part.body)];
      radius_m = std::max(radius_m, part.p_BG.norm() + BoundingRadius(part.shape));
    }
    if (std::abs(placed.p[2] - placed.half_m.z()) <= kSupportGap_m)
      robot.floor_rows += part.friction > 0 ? 3 : 1;
  }
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const PlacedPart placed = AtOrigin(robot, robot.parts[i]);
    const auto* cylinder = std::get_if<Cylinder>(&robot.parts[i].shape);
    if (cylinder == nullptr || placed.R[10] < 1 - 1e-9) continue;
    if (portable::Hypot(placed.p[0], placed.p[1]) > 1e-9 || cylinder->radius_m < robot.radius_m - 1e-9)
      continue;
    robot.shell = static_cast<int>(i);
  }
}

}  // namespace

Mechanism MakeRobot(const RobotModel& model, Fidelity fidelity, double floor_friction, const Vector3& g_W) {
  Mechanism robot;
  robot.model = &model;
  robot.fidelity = fidelity;
  if (robot.one_body()) {
    AddOneBody(robot);
  } else {
    AddLinks(robot);
  }
  PlaceGrains(robot);
  Measure(robot);
  robot.has_soft_parts = std::ranges::any_of(
      robot.parts, [](const Part& part) { return std::isfinite(part.contact_stiffness_n_m); });
  constexpr double kHingeSlack_m = 0.01;  // links give way a little under load
  if (!robot.one_body()) {
    robot.radius_m += kHingeSlack_m;
    robot.reach_m += kHingeSlack_m;
    robot.tree = TreeOf(robot);
    return robot;
  }
  robot.tree = TreeOf(robot);
  std::string why;
  if (const auto wheels = FindWheels(model, why)) {
    robot.drive = MakeDrive(robot, *wheels, floor_friction, g_W);
  }
  if (robot.planar()) {
    // Keeps the robot from tilting.
    constexpr double kUntiltable_kg_m2 = 1e6;
    Matrix3& I = robot.bodies.front().inertia_kg_m2;
    I = Vector3(kUntiltable_kg_m2, kUntiltable_kg_m2, I(2, 2)).asDiagonal();
  }
  return robot;
}

Mechanism MakeObject(const WorldObject& object) {
  Mechanism mechanism;
  Part part{object.shape};
  part.friction = object.friction;
  part.restitution = object.restitution;
  part.rolling_friction_m = object.rolling_friction_m;
  // Shapes that touch at several points do not spin easily anyway.
  if (std::holds_alternative<Sphere>(object.shape)) part.spinning_friction_m = object.rolling_friction_m;
  mechanism.parts = {part};
  if (!object.is_static()) {
    mechanism.bodies = {{object.mass_kg, SolidInertia(object.shape, object.mass_kg).asDiagonal(), {}}};
    mechanism.tree = TreeOf(mechanism);
  }
  return mechanism;
}

}  // namespace coopdyn
