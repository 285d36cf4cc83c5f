// SPDX-License-Identifier: MIT
// Reads the drive of a model made for Gazebo: moves R below the axle, turns axes to point left, and adds
// missing motor limits.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "server/base/portable_math.h"
#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kSame_m = 1e-3;

/// True for a usable limit: a model may also have 0, none, or an unlimited number.
bool IsLimit(double value, double most) {
  return value > 0 && value <= most;
}

class DriveAdopter {
 public:
  DriveAdopter(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
               Diagnostics& diagnostics)
      : where_{file, element.GetLineNum()},
        attributes_(element, file, diagnostics),
        robot_(robot),
        diagnostics_(diagnostics) {}

  void Adopt() {
    std::vector<Wheel> wheels = FindWheels();
    steers_ = FindSteering();
    // Driven steered wheels would drag: their speeds differ from those of the rear axle.
    if (steers_) std::erase_if(wheels, [this](const Wheel& wheel) { return IsSteered(wheel); });
    const auto pair = FindPair(wheels);
    if (!pair)
      return Leave(
          "no two of its wheels are opposite each other: name two of one radius on one line along y");
    const auto& [left_wheel, right_wheel] = *pair;
    for (const Wheel* wheel : {left_wheel, right_wheel}) {
      JointModel& joint = JointOf(*wheel);
      if (std::abs(joint.axis_R.y()) < 1 - 1e-6)
        return Leave("the axis of '" + joint.name +
                     "' does not lie along y: write <xyz>0 1 0</xyz> in the model's frame");
      if (joint.axis_R.y() < 0) Reverse(wheel->joint);
      joint.axis_R = Vector3::UnitY();
      joint.lower = -JointModel::kInfinity;
      joint.upper = JointModel::kInfinity;
      joint.damping = joint.friction = joint.stiffness = 0;
    }
    const Vector3 p_left = left_wheel->p_R, p_right = right_wheel->p_R;
    const double radius_m = left_wheel->radius_m;
    for (const Wheel& wheel : wheels) {
      const bool is_left = wheel.p_R.y() > (p_left.y() + p_right.y()) / 2;
      WarnSide(wheel, is_left);
      if (wheel.joint != left_wheel->joint && wheel.joint != right_wheel->joint)
        Couple(wheel.joint, is_left ? left_wheel->joint : right_wheel->joint);
    }
    MoveOrigin({(p_left.x() + p_right.x()) / 2, (p_left.y() + p_right.y()) / 2, p_left.z() - radius_m});
    FillMotors(JointOf(*left_wheel), JointOf(*right_wheel), radius_m);
    const JointModel& left = JointOf(*left_wheel);
    DriveModel drive{.wheel_radius_m = radius_m,
                     .track_m = p_left.y() - p_right.y(),
                     .max_wheel_speed_rad_s = left.max_velocity,
                     .max_torque_nm = left.max_effort};
    if (steers_) drive.steering = Steering();
    robot_.actuators.push_back({"motors", {left_wheel->joint, right_wheel->joint}, drive});
  }

 private:
  struct Wheel {
    int joint = 0;
    bool is_named_left = false;
    Vector3 p_R = Vector3::Zero();
    double radius_m = 0;
  };

  /// The left and right steering joints; nullopt for a differential drive.
  std::optional<std::pair<int, int>> FindSteering() {
    std::vector<int> found;
    for (const char* key : {"steer_left", "steer_right"}) {
      const auto name = attributes_.Text(key);
      const auto joint = std::ranges::find(robot_.joints, name.value_or(""), &JointModel::name);
      if (!name || joint == robot_.joints.end() || joint->kind != JointModel::Kind::kHinge) continue;
      found.push_back(static_cast<int>(joint - robot_.joints.begin()));
    }
    if (found.size() != 2) return std::nullopt;
    return std::pair(found[0], found[1]);
  }

  JointModel& JointAt(int joint) { return robot_.joints[static_cast<std::size_t>(joint)]; }
  bool IsSteered(const Wheel& wheel) {
    const int holder = JointOf(wheel).parent;
    return holder == JointAt(steers_->first).child || holder == JointAt(steers_->second).child;
  }

  /// The steering, by joints with vertical axes in front of the axle, which is R's y axis. Warns and returns
  /// nullopt if the joints do not fit.
  std::optional<DriveModel::Steering> Steering() {
    const auto refuse = [this](const std::string& why) {
      diagnostics_.Warning(where_, "the drive does not steer, since " + why);
      return std::nullopt;
    };
    DriveModel::Steering steering;
    steering.joints = {steers_->first, steers_->second};
    constexpr double kMostAngle_rad = std::numbers::pi / 3;  // beyond this the wheels only drag
    double angle_rad = attributes_.Number("steering_limit", 1e-3, std::numbers::pi).value_or(kMostAngle_rad);
    angle_rad = std::min(angle_rad, kMostAngle_rad);
    for (const int index : steering.joints) {
      JointModel& joint = JointAt(index);
      if (std::abs(joint.axis_R.z()) < 1 - 1e-6)
        return refuse("the axis of '" + joint.name + "' does not stand upright: write <xyz>0 0 1</xyz>");
      if (joint.axis_R.z() < 0) {
        Reverse(index);
        joint.lower = -std::exchange(joint.upper, -joint.lower);
      }
      joint.axis_R = Vector3::UnitZ();
      joint.damping = joint.friction = joint.stiffness = 0;
      constexpr double kEffort_nm = 100, kVelocity_rad_s = 10;
      if (!IsLimit(joint.max_effort, kMaxMotorEffort)) joint.max_effort = kEffort_nm;
      if (!IsLimit(joint.max_velocity, kMaxMotorVelocity)) joint.max_velocity = kVelocity_rad_s;
      angle_rad = std::min({angle_rad, -joint.lower, joint.upper});
    }
    const Vector3 left = JointAt(steering.joints[0]).p_RJ, right = JointAt(steering.joints[1]).p_RJ;
    steering.wheelbase_m = left.x();
    steering.half_track_m = left.y();
    if (!(left.x() > kSame_m && left.y() > kSame_m) || std::abs(left.x() - right.x()) > kSame_m ||
        std::abs(left.y() + right.y()) > kSame_m)
      return refuse(
          "the axes of its steered wheels do not stand before the axle, left and right of the middle");
    if (!(angle_rad > 0)) return refuse("its <limit>s exclude straight ahead");
    // The inner wheel turns most.
    const double tangent = portable::Tan(angle_rad);
    steering.max_curvature_1_m = tangent / (steering.wheelbase_m + steering.half_track_m * tangent);
    return steering;
  }

  void Leave(const std::string& why) {
    diagnostics_.Warning(where_, "the differential drive has no module 'motors', since " + why);
  }

  JointModel& JointOf(const Wheel& wheel) { return robot_.joints[static_cast<std::size_t>(wheel.joint)]; }

  void LeaveOut(const std::string& joint, const std::string& why) {
    diagnostics_.Warning(where_, "the differential drive leaves out the wheel at '" + joint + "': " + why);
  }

  /// All wheels that the plugin names, the left ones first. Warns about joints that are not wheels.
  std::vector<Wheel> FindWheels() {
    std::vector<Wheel> wheels;
    for (const std::string side : {"left", "right"}) {
      std::vector<std::string> names = SplitWords(attributes_.Text("other_" + side + "_joints").value_or(""));
      names.insert(names.begin(), attributes_.Text(side + "_joint").value_or(""));
      for (const std::string& name : names) {
        const auto found = std::ranges::find(robot_.joints, name, &JointModel::name);
        const auto joint = static_cast<int>(found - robot_.joints.begin());
        if (found == robot_.joints.end() || found->kind != JointModel::Kind::kHinge ||
            robot_.FindCoupling(joint) != nullptr) {
          LeaveOut(name, "there is no turning joint of this name that follows no other");
        } else if (std::ranges::find(wheels, joint, &Wheel::joint) != wheels.end()) {
          LeaveOut(name, "it is named twice");
        } else if (auto wheel = WheelOf(joint)) {
          wheel->is_named_left = side == "left";
          wheels.push_back(*wheel);
        } else {
          LeaveOut(name, "its link has no cylinder or sphere about the axis: write one as <collision>");
        }
      }
    }
    return wheels;
  }

  /// The first two wheels, left and right, that are opposite each other; nullopt if none.
  std::optional<std::pair<const Wheel*, const Wheel*>> FindPair(const std::vector<Wheel>& wheels) {
    for (const bool by_name : {true, false}) {
      for (const Wheel& one : wheels) {
        for (const Wheel& other : wheels) {
          const Vector3 way = one.p_R - other.p_R;
          if ((!by_name || one.is_named_left != other.is_named_left) && way.y() > kSame_m &&
              std::abs(way.x()) <= kSame_m && std::abs(way.z()) <= kSame_m &&
              std::abs(one.radius_m - other.radius_m) <= kSame_m)
            return std::pair(&one, &other);
        }
      }
    }
    return std::nullopt;
  }

  /// Adjusts couplings for a leader whose positions change sign, so that followers move as before.
  void Reverse(int joint) {
    for (CouplingModel& coupling : robot_.couplings) {
      if (coupling.leader == joint) coupling.multiplier = -coupling.multiplier;
    }
  }

  /// Warns about a wheel named for the wrong side. Gazebo uses the names, so it turns such a model the other
  /// way.
  void WarnSide(const Wheel& wheel, bool is_left) {
    if (wheel.is_named_left == is_left) return;
    const std::string right = is_left ? "left" : "right", wrong = is_left ? "right" : "left";
    diagnostics_.Mended(where_, "the wheel at '" + JointOf(wheel).name + "' is named " + wrong +
                                    " and is on the " + right + ", where y is " +
                                    (is_left ? "larger" : "smaller") + ": it turns as a " + right +
                                    " one; write <" + right + "_joint>");
  }

  /// Couples an additional wheel to the wheel of the pair on its side.
  void Couple(int follower, int leader) {
    const JointModel& other = robot_.joints[static_cast<std::size_t>(follower)];
    const bool leads = std::ranges::count(robot_.couplings, follower, &CouplingModel::leader) > 0;
    if (leads || std::abs(other.axis_R.y()) < 1 - 1e-6) {
      diagnostics_.Warning(
          where_, "the wheel at '" + other.name +
                      "' is not driven: its axis must lie along y, and no other joint may follow it");
    } else {
      robot_.couplings.push_back({follower, leader, other.axis_R.y() < 0 ? -1.0 : 1.0, 0});
    }
  }

  /// The wheel of a joint: a round collision centred on its axis, else the plugin's values.
  std::optional<Wheel> WheelOf(int index) {
    const JointModel& joint = robot_.joints[static_cast<std::size_t>(index)];
    const LinkModel& link = robot_.links[static_cast<std::size_t>(joint.child)];
    const auto on_axis = [&joint](const Vector3& p) {
      const Vector3 d = p - joint.p_RJ;
      return (d - d.dot(joint.axis_R) * joint.axis_R).norm() < kSame_m;
    };
    for (const LinkShape& collision : link.collisions) {
      const Pose X_RG = link.X_RL * collision.X_LG;
      if (!on_axis(X_RG.p)) continue;
      if (const auto* sphere = std::get_if<Sphere>(&collision.shape))
        return Wheel{index, false, X_RG.p, sphere->radius_m};
      const auto* cylinder = std::get_if<Cylinder>(&collision.shape);
      if (cylinder != nullptr && std::abs((X_RG.q * Vector3::UnitZ()).dot(joint.axis_R)) > 1 - 1e-6)
        return Wheel{index, false, X_RG.p, cylinder->radius_m};
    }
    const auto radius = attributes_.Number("radius", 1e-4, 1e3);
    const auto diameter = attributes_.Number("diameter", 1e-4, 1e3);
    if (!radius && !diameter) return std::nullopt;
    return Wheel{index, false, link.X_RL * link.X_LI.p, radius ? *radius : *diameter / 2};
  }

  /// Moves R's origin to `p`.
  void MoveOrigin(const Vector3& p) {
    if (p.norm() < 1e-9) return;
    for (LinkModel& link : robot_.links) link.X_RL.p -= p;
    for (JointModel& joint : robot_.joints) joint.p_RJ -= p;
    for (FrameModel& frame : robot_.frames) frame.X_RF.p -= p;
    robot_.p_MR += p;
    if (p.norm() > kSame_m) {
      diagnostics_.Mended(where_, "the robot's origin is on the floor under the middle of the axle, at " +
                                      FormatNumber(std::round(p.x() * 1e4) / 1e4 + 0.0) + " " +
                                      FormatNumber(std::round(p.y() * 1e4) / 1e4 + 0.0) + " " +
                                      FormatNumber(std::round(p.z() * 1e4) / 1e4 + 0.0) + " of the model's");
    }
  }

  void FillMotors(JointModel& left, JointModel& right, double radius_m) {
    double mass_kg = 0;
    for (const LinkModel& link : robot_.links) mass_kg += link.mass_kg;
    constexpr double kGravity_m_s2 = 9.81, kTopSpeed_m_s = 2;
    double torque_nm = std::min(left.max_effort, right.max_effort);
    if (const auto given = attributes_.Number("torque", 1e-9, kMaxMotorEffort);
        given && !IsLimit(torque_nm, kMaxMotorEffort))
      torque_nm = *given;
    if (!IsLimit(torque_nm, kMaxMotorEffort)) torque_nm = 0.5 * mass_kg * kGravity_m_s2 * radius_m;
    double speed_rad_s = std::min(left.max_velocity, right.max_velocity);
    if (!IsLimit(speed_rad_s, kMaxMotorVelocity)) speed_rad_s = kTopSpeed_m_s / radius_m;
    if (!IsLimit(left.max_effort, kMaxMotorEffort) || !IsLimit(left.max_velocity, kMaxMotorVelocity)) {
      diagnostics_.Mended(where_, "the wheels' joints have no <effort> or <velocity>: each motor has " +
                                      FormatNumber(std::round(torque_nm * 1e3) / 1e3) + " N m and turns at " +
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
  std::optional<std::pair<int, int>> steers_;
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
    diagnostics.Note(attributes.where(), "there is no joint '" + name + "' for its controller plug-in");
    return;
  }
  const int joint = static_cast<int>(found - robot.joints.begin());
  if (robot.IsDriven(joint) || !found->has_axis()) return;
  if (robot.FindCoupling(joint) != nullptr) {
    diagnostics.Note(attributes.where(), "the controller plug-in of joint '" + name +
                                             "' is not used: the joint follows another (<mimic>)");
    return;
  }
  constexpr double kEffort = 100, kVelocity = 10;
  const bool no_effort = !IsLimit(found->max_effort, kMaxMotorEffort);
  const bool no_velocity = !IsLimit(found->max_velocity, kMaxMotorVelocity);
  if (no_effort) found->max_effort = attributes.Number("effort", 1e-9, 1e6).value_or(kEffort);
  if (no_velocity) found->max_velocity = kVelocity;
  if (no_effort || no_velocity) {
    diagnostics.Mended(attributes.where(), "joint '" + name +
                                               "' says no <effort> or <velocity>: its motor has " +
                                               FormatNumber(found->max_effort) + " and " +
                                               FormatNumber(found->max_velocity) + " at most (SI units)");
  }
}

}  // namespace coopdyn
