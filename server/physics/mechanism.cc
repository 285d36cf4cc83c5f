// SPDX-License-Identifier: MIT
#include "server/physics/mechanism.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

// What is this near the floor when the robot stands on it carries it.
constexpr double kSupportGap_m = 2e-4;
// Of the acceleration at which a wheel or caster lifts.
constexpr double kTipShare = 0.8;

Pose PlaceInR(const LinkModel& link, const LinkShape& collision) {
  return link.X_RL * collision.X_LG;
}

/// Where the robot stands on the floor, from its centre of mass.
struct Support {
  double x = 0, y = 0;
  int side = -1;  // of a wheel
};

/// How far the hull of `supports` reaches from the centre of mass along (dx, dy); 0 if it is not within.
double Reach(const std::vector<Support>& supports, double dx, double dy) {
  double reach = 0;
  for (const Support& a : supports) {
    for (const Support& b : supports) {
      // Where the ray meets the segment from a to b.
      const double across_a = dx * a.y - dy * a.x, across_b = dx * b.y - dy * b.x;
      if (across_a > 0 || across_b < 0) continue;
      const double span = across_b - across_a;
      const double share = span > 0 ? -across_a / span : 0;
      const double along = dx * (a.x + share * (b.x - a.x)) + dy * (a.y + share * (b.y - a.y));
      reach = std::max(reach, along);
    }
  }
  return reach;
}

/// The loads of equally springy supports under a weight.
std::vector<double> Loads(const std::vector<Support>& supports, double weight_n) {
  Matrix3 sums = Matrix3::Identity() * 1e-12;
  for (const Support& s : supports) {
    const Vector3 row(1, s.x, s.y);
    sums += row * row.transpose();
  }
  const Vector3 k = sums.ldlt().solve(Vector3(weight_n, 0, 0));
  std::vector<double> loads;
  for (const Support& s : supports) loads.push_back(std::max(0.0, k.x() + k.y() * s.x + k.z() * s.y));
  return loads;
}

/// The side (0 left, 1 right) of the driven wheel whose tread `collision` of link `link` is; -1: it is none.
int WheelSide(const RobotModel& model, int link, const LinkShape& collision) {
  if (!std::holds_alternative<Cylinder>(collision.shape)) return -1;
  for (int side = 0; side < 2; ++side) {
    const int driven = side == 0 ? model.drive.left_joint : model.drive.right_joint;
    if (driven < 0 || static_cast<std::size_t>(driven) >= model.joints.size()) continue;
    const JointModel& joint = model.joints[static_cast<std::size_t>(driven)];
    if (joint.child != link) continue;
    const Quaternion q_RG = model.links[static_cast<std::size_t>(link)].X_RL.q * collision.X_LG.q;
    if (std::abs((q_RG * Vector3::UnitZ()).dot(joint.axis_R.normalized())) > 0.999) return side;
  }
  return -1;
}

Matrix3 Turned(const Vector3& moments, const Matrix3& R) {
  const Matrix3 I = R * moments.asDiagonal() * R.transpose();
  return (I + I.transpose()) / 2;
}

Part MakePart(const RobotModel& model, std::size_t link, const LinkShape& collision) {
  Part part{collision.shape};
  part.friction = collision.friction;
  part.side = WheelSide(model, static_cast<int>(link), collision);
  part.is_wheel = part.side >= 0;
  return part;
}

/// All links welded into one body.
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

/// Each link a body.
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
    const JointModel& joint = model.joints[j];
    Hinge hinge{joint.parent, joint.child, joint.p_RJ, joint.axis_R};
    for (int side = 0; side < 2; ++side) {
      const int driven = side == 0 ? model.drive.left_joint : model.drive.right_joint;
      if (driven == static_cast<int>(j)) hinge.side = side;
    }
    hinge.max_torque_nm = model.drive.max_torque_nm;
    robot.joint_rows += hinge.side >= 0 ? 6 : 5;
    robot.hinges.push_back(hinge);
  }
}

/// A part of a robot that stands at the origin.
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

/// Radius about R's z axis of the vertical cylinder that holds a part.
double RadiusOf(const PlacedPart& placed) {
  const double x = placed.p[0], y = placed.p[1];
  const bool round =
      std::holds_alternative<Sphere>(placed.part->shape) ||
      (std::holds_alternative<Cylinder>(placed.part->shape) && std::abs(placed.R[10]) > 1 - 1e-9);
  if (round) return std::hypot(x, y) + placed.half_m.x();
  return std::hypot(std::abs(x) + placed.half_m.x(), std::abs(y) + placed.half_m.y());
}

void Measure(Mechanism& robot) {
  for (const Part& part : robot.parts) {
    const PlacedPart placed = AtOrigin(robot, part);
    robot.radius_m = std::max(robot.radius_m, RadiusOf(placed));
    robot.reach_m = std::max(robot.reach_m, placed.place().position().norm() + BoundingRadius(part.shape));
    robot.height_m = std::max(robot.height_m, placed.p[2] + placed.half_m.z());
    if (std::abs(placed.p[2] - placed.half_m.z()) <= kSupportGap_m)
      robot.floor_rows += part.friction > 0 ? 3 : 1;
  }
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const PlacedPart placed = AtOrigin(robot, robot.parts[i]);
    const auto* cylinder = std::get_if<Cylinder>(&robot.parts[i].shape);
    if (cylinder == nullptr || placed.R[10] < 1 - 1e-9) continue;
    if (std::hypot(placed.p[0], placed.p[1]) > 1e-9 || cylinder->radius_m < robot.radius_m - 1e-9) continue;
    robot.shell = static_cast<int>(i);
  }
}

OneBodyDrive MakeDrive(const Mechanism& robot, const WheelPair& wheels, double floor_friction,
                       double gravity_m_s2) {
  const RigidBody& body = robot.bodies.front();
  const Vector3& p_RB = body.X_RB.p;
  OneBodyDrive drive;
  drive.wheels = wheels;
  drive.mass_kg = body.mass_kg;
  drive.p_RB = p_RB;
  std::vector<Support> supports;
  for (const Part& part : robot.parts) {
    const double lowest_m = p_RB.z() + part.p_BG.z() - HalfExtents(part.shape, part.R_BG).z();
    if (std::abs(lowest_m) <= kSupportGap_m) supports.push_back({part.p_BG.x(), part.p_BG.y(), part.side});
  }
  const double weight_n = body.mass_kg * gravity_m_s2;
  constexpr std::array<std::array<double, 2>, 4> kWays{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  drive.stands = std::all_of(kWays.begin(), kWays.end(),
                             [&](const auto& way) { return Reach(supports, way[0], way[1]) > 1e-3; });
  drive.load_n = {weight_n / 2, weight_n / 2};
  if (drive.stands) {
    const std::vector<double> loads = Loads(supports, weight_n);
    for (std::size_t i = 0; i < supports.size(); ++i) {
      if (supports[i].side >= 0) drive.load_n[static_cast<std::size_t>(supports[i].side)] = loads[i];
    }
  }
  drive.max_torque_nm = robot.model->drive.max_torque_nm;
  drive.stalls = true;
  for (std::size_t side = 0; side < 2; ++side) {
    const double grip_n = std::min(wheels.friction[side], floor_friction) * drive.load_n[side];
    const double motor_n = drive.max_torque_nm / wheels.radius_m;
    drive.drive_n[side] = std::min(grip_n, motor_n);
    drive.stalls = drive.stalls && motor_n < grip_n;
    drive.sideways_n += grip_n;
  }
  drive.yaw_inertia_kg_m2 = body.inertia_kg_m2(2, 2) + body.mass_kg * p_RB.head<2>().squaredNorm();
  drive.max_across_m_s2 = drive.sideways_n / body.mass_kg;
  drive.max_along_m_s2 = 1e9;
  if (robot.planar()) {
    drive.stands = true;  // cannot tip
    return drive;
  }
  const double tip = kTipShare * gravity_m_s2 / std::max(1e-6, p_RB.z());
  drive.max_along_m_s2 = tip * std::min(Reach(supports, 1, 0), Reach(supports, -1, 0));
  drive.max_across_m_s2 =
      std::min(drive.max_across_m_s2, tip * std::min(Reach(supports, 0, 1), Reach(supports, 0, -1)));
  return drive;
}

}  // namespace

std::optional<WheelPair> FindWheels(const RobotModel& model, std::string& why) {
  constexpr double kTolerance_m = 1e-4;
  WheelPair pair;
  std::array<double, 2> y_m{}, radius_m{};
  std::array<int, 2> found{};
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    for (const LinkShape& collision : model.links[k].collisions) {
      const int side = WheelSide(model, static_cast<int>(k), collision);
      if (side < 0) continue;
      const std::size_t s = static_cast<std::size_t>(side);
      const JointModel& joint =
          model
              .joints[static_cast<std::size_t>(side == 0 ? model.drive.left_joint : model.drive.right_joint)];
      const Pose X_RG = PlaceInR(model.links[k], collision);
      y_m[s] = X_RG.p.y();
      radius_m[s] = std::get<Cylinder>(collision.shape).radius_m;
      pair.friction[s] = collision.friction;
      ++found[s];
      if (joint.axis_R.normalized().y() < 0.9999 || std::abs(X_RG.p.x()) > kTolerance_m ||
          std::abs(X_RG.p.z() - radius_m[s]) > kTolerance_m) {
        why = "its wheels must stand on the y axis and turn about it";
        return std::nullopt;
      }
    }
  }
  if (found[0] != 1 || found[1] != 1) {
    why = "each of its two wheels must be one cylinder about its axle";
    return std::nullopt;
  }
  if (std::abs(radius_m[0] - radius_m[1]) > kTolerance_m || std::abs(y_m[0] + y_m[1]) > kTolerance_m ||
      y_m[0] <= 0) {
    why = "its wheels must be equal and as far from the middle on either side";
    return std::nullopt;
  }
  pair.radius_m = (radius_m[0] + radius_m[1]) / 2;
  pair.half_track_m = (y_m[0] - y_m[1]) / 2;
  return pair;
}

Mechanism MakeRobot(const RobotModel& model, Fidelity fidelity, double floor_friction, double gravity_m_s2) {
  Mechanism robot;
  robot.model = &model;
  robot.fidelity = fidelity;
  if (robot.one_body()) {
    AddOneBody(robot);
  } else {
    AddLinks(robot);
  }
  Measure(robot);
  constexpr double kHingeSlack_m = 0.01;  // links give way a little under load
  if (!robot.one_body()) {
    robot.radius_m += kHingeSlack_m;
    robot.reach_m += kHingeSlack_m;
    return robot;
  }
  std::string why;
  if (const auto wheels = FindWheels(model, why)) {
    robot.drive = MakeDrive(robot, *wheels, floor_friction, gravity_m_s2);
  }
  return robot;
}

Mechanism MakeObject(const WorldObject& object) {
  Mechanism mechanism;
  Part part{object.shape};
  part.friction = object.friction;
  mechanism.parts = {part};
  if (!object.is_static()) {
    mechanism.bodies = {{object.mass_kg, SolidInertia(object.shape, object.mass_kg).asDiagonal(), {}}};
  }
  return mechanism;
}

}  // namespace coopdyn
