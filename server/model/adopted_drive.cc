// SPDX-License-Identifier: MIT
// The drive of a model made for Gazebo: R is moved under the axle, axes are turned to point left, and what
// the motors lack is filled in.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kSame_m = 1e-3;

class DriveAdopter {
 public:
  DriveAdopter(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
               Diagnostics& diagnostics)
      : where_{file, element.GetLineNum()},
        attributes_(element, file, diagnostics),
        robot_(robot),
        diagnostics_(diagnostics) {}

  void Adopt() {
    JointModel* left = Find("left_joint");
    JointModel* right = Find("right_joint");
    if (left == nullptr || right == nullptr || left == right) return;
    const auto left_wheel = WheelOf(*left), right_wheel = WheelOf(*right);
    if (!left_wheel || !right_wheel) return;
    Vector3 p_left = left_wheel->p_R, p_right = right_wheel->p_R;
    if (p_left.y() < p_right.y()) return Leave("the left wheel is right of the right one: swap their names");
    const double radius_m = left_wheel->radius_m;
    if (std::abs(radius_m - right_wheel->radius_m) > kSame_m) return Leave("the wheels have different radii");
    if (std::abs(p_left.x() - p_right.x()) > kSame_m || std::abs(p_left.z() - p_right.z()) > kSame_m)
      return Leave("the wheels are not opposite each other: put both on one line along y");
    for (JointModel* joint : {left, right}) {
      if (std::abs(joint->axis_R.y()) < 1 - 1e-6)
        return Leave("the axis of '" + joint->name +
                     "' does not lie along y: write <xyz>0 1 0</xyz> in the model's frame");
      if (joint->axis_R.y() < 0) Reverse(static_cast<int>(joint - robot_.joints.data()));
      joint->axis_R = Vector3::UnitY();
      joint->lower = -JointModel::kInfinity;
      joint->upper = JointModel::kInfinity;
      joint->damping = joint->friction = joint->stiffness = 0;
    }
    CoupleOthers("other_left_joints", static_cast<int>(left - robot_.joints.data()));
    CoupleOthers("other_right_joints", static_cast<int>(right - robot_.joints.data()));
    MoveOrigin({(p_left.x() + p_right.x()) / 2, (p_left.y() + p_right.y()) / 2, p_left.z() - radius_m});
    FillMotors(*left, *right, radius_m);
    robot_.actuators.push_back(
        {"motors",
         {static_cast<int>(left - robot_.joints.data()), static_cast<int>(right - robot_.joints.data())},
         DriveModel{.wheel_radius_m = radius_m,
                    .track_m = p_left.y() - p_right.y(),
                    .max_wheel_speed_rad_s = left->max_velocity,
                    .max_torque_nm = left->max_effort}});
  }

 private:
  struct Wheel {
    Vector3 p_R;
    double radius_m = 0;
  };

  void Leave(const std::string& why) {
    diagnostics_.Warning(where_, "the differential drive has no module 'motors', since " + why);
  }

  JointModel* Find(const char* key) { return FindJoint(attributes_.Text(key).value_or("")); }

  JointModel* FindJoint(const std::string& name) {
    const auto found = std::ranges::find(robot_.joints, name, &JointModel::name);
    if (found != robot_.joints.end() && found->kind == JointModel::Kind::kHinge &&
        robot_.FindCoupling(static_cast<int>(found - robot_.joints.begin())) == nullptr)
      return &*found;
    Leave("there is no turning joint '" + name + "' that follows no other");
    return nullptr;
  }

  /// Its positions count the other way, and what follows it goes on as before.
  void Reverse(int joint) {
    for (CouplingModel& coupling : robot_.couplings) {
      if (coupling.leader == joint) coupling.multiplier = -coupling.multiplier;
    }
  }

  /// The wheels that the plug-in names after the first one turn as that does.
  void CoupleOthers(const char* key, int leader) {
    for (const std::string& name : SplitWords(attributes_.Text(key).value_or(""))) {
      const JointModel* const other = FindJoint(name);
      if (other == nullptr) continue;
      const auto follower = static_cast<int>(other - robot_.joints.data());
      const bool leads = std::ranges::count(robot_.couplings, follower, &CouplingModel::leader) > 0;
      if (leads || std::abs(other->axis_R.y()) < 1 - 1e-6) {
        diagnostics_.Warning(
            where_, "the wheel at '" + name +
                        "' is not driven: its axis must lie along y, and no other joint may follow it");
      } else {
        robot_.couplings.push_back({follower, leader, other->axis_R.y() < 0 ? -1.0 : 1.0, 0});
      }
    }
  }

  /// A round collision whose middle lies on the joint's axis; else what the plug-in says of the wheel.
  std::optional<Wheel> WheelOf(const JointModel& joint) {
    const LinkModel& link = robot_.links[static_cast<std::size_t>(joint.child)];
    const auto on_axis = [&joint](const Vector3& p) {
      const Vector3 d = p - joint.p_RJ;
      return (d - d.dot(joint.axis_R) * joint.axis_R).norm() < kSame_m;
    };
    for (const LinkShape& collision : link.collisions) {
      const Pose X_RG = link.X_RL * collision.X_LG;
      if (!on_axis(X_RG.p)) continue;
      if (const auto* sphere = std::get_if<Sphere>(&collision.shape)) return Wheel{X_RG.p, sphere->radius_m};
      const auto* cylinder = std::get_if<Cylinder>(&collision.shape);
      if (cylinder != nullptr && std::abs((X_RG.q * Vector3::UnitZ()).dot(joint.axis_R)) > 1 - 1e-6)
        return Wheel{X_RG.p, cylinder->radius_m};
    }
    const auto radius = attributes_.Number("radius", 1e-4, 1e3);
    const auto diameter = attributes_.Number("diameter", 1e-4, 1e3);
    if (!radius && !diameter) {
      Leave("the wheel '" + link.name +
            "' has no cylinder or sphere about the axis of its joint: write one as <collision>");
      return std::nullopt;
    }
    return Wheel{link.X_RL * link.X_LI.p, radius ? *radius : *diameter / 2};
  }

  /// R's origin is `p` of before.
  void MoveOrigin(const Vector3& p) {
    if (p.norm() < 1e-9) return;
    for (LinkModel& link : robot_.links) link.X_RL.p -= p;
    for (JointModel& joint : robot_.joints) joint.p_RJ -= p;
    for (FrameModel& frame : robot_.frames) frame.X_RF.p -= p;
    robot_.p_MR += p;
    if (p.norm() > kSame_m) {
      diagnostics_.Warning(where_, "the robot's origin is on the floor under the middle of the axle, at " +
                                       FormatNumber(std::round(p.x() * 1e4) / 1e4 + 0.0) + " " +
                                       FormatNumber(std::round(p.y() * 1e4) / 1e4 + 0.0) + " " +
                                       FormatNumber(std::round(p.z() * 1e4) / 1e4 + 0.0) + " of the model's");
    }
  }

  void FillMotors(JointModel& left, JointModel& right, double radius_m) {
    double mass_kg = 0;
    for (const LinkModel& link : robot_.links) mass_kg += link.mass_kg;
    constexpr double kGravity_m_s2 = 9.81, kTopSpeed_m_s = 2;
    const auto good = [](double x) { return std::isfinite(x) && x > 0; };
    double torque_nm = std::min(left.max_effort, right.max_effort);
    if (const auto given = attributes_.Number("torque", 1e-9, 1e6); given && !good(torque_nm))
      torque_nm = *given;
    if (!good(torque_nm) || torque_nm > 1e6) torque_nm = 0.5 * mass_kg * kGravity_m_s2 * radius_m;
    double speed_rad_s = std::min(left.max_velocity, right.max_velocity);
    if (!good(speed_rad_s) || speed_rad_s > 1e4) speed_rad_s = kTopSpeed_m_s / radius_m;
    if (!good(left.max_effort) || !good(left.max_velocity)) {
      diagnostics_.Warning(where_, "the wheels' joints say no <effort> or <velocity>: each motor has " +
                                       FormatNumber(std::round(torque_nm * 1e3) / 1e3) +
                                       " N m and turns at " +
                                       FormatNumber(std::round(speed_rad_s * 1e3) / 1e3) + " rad/s at most");
    }
    for (JointModel* joint : {&left, &right}) {
      joint->max_effort = torque_nm;
      joint->max_velocity = speed_rad_s;
    }
  }

  const SourceLine where_;
  XmlAttributes attributes_;
  RobotModel& robot_;
  Diagnostics& diagnostics_;
};

}  // namespace

void AdoptDrive(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics) {
  DriveAdopter(element, file, robot, diagnostics).Adopt();
}

void AdoptJoint(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics) {
  XmlAttributes attributes(element, file, diagnostics);
  const std::string name = attributes.Text("joint").value_or("");
  const auto found = std::ranges::find(robot.joints, name, &JointModel::name);
  if (found == robot.joints.end()) {
    diagnostics.Warning(attributes.where(), "there is no joint '" + name + "' for its controller plug-in");
    return;
  }
  if (robot.FindCoupling(static_cast<int>(found - robot.joints.begin())) != nullptr) {
    diagnostics.Warning(attributes.where(), "the controller plug-in of joint '" + name +
                                                "' is not used: the joint follows another (<mimic>)");
    return;
  }
  constexpr double kEffort = 100, kVelocity = 10;
  const bool no_effort = !std::isfinite(found->max_effort) || found->max_effort <= 0;
  const bool no_velocity = !std::isfinite(found->max_velocity) || found->max_velocity <= 0;
  if (no_effort) found->max_effort = attributes.Number("effort", 1e-9, 1e6).value_or(kEffort);
  if (no_velocity) found->max_velocity = kVelocity;
  if (no_effort || no_velocity) {
    diagnostics.Warning(attributes.where(), "joint '" + name +
                                                "' says no <effort> or <velocity>: its motor has " +
                                                FormatNumber(found->max_effort) + " and " +
                                                FormatNumber(found->max_velocity) + " at most (SI units)");
  }
}

}  // namespace coopdyn
