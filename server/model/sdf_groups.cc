// SPDX-License-Identifier: MIT
// Reads groups of joints: `<coopdyn:group>`.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

bool HasMotor(const JointModel& joint) {
  return joint.max_effort > 0 && joint.max_effort <= kMaxMotorEffort && joint.max_velocity > 0 &&
         joint.max_velocity <= kMaxMotorVelocity;
}

std::vector<std::string> NamesOf(const auto& parts) {
  std::vector<std::string> names;
  for (const auto& part : parts) names.push_back(part.name);
  return names;
}

/// Adds the joint `name` to the group, or reports why that is impossible.
void AddJoint(XmlAttributes& attributes, const std::string& name, const RobotModel& robot,
              std::vector<int>& joints) {
  const auto found = std::ranges::find(robot.joints, name, &JointModel::name);
  if (found == robot.joints.end()) {
    return attributes.Error("there is no joint '" + name + "'" + DidYouMean(name, NamesOf(robot.joints)));
  }
  const auto index = static_cast<int>(found - robot.joints.begin());
  if (std::ranges::find(joints, index) != joints.end()) {
    return attributes.Error("the joint '" + name + "' is named twice: name each joint once");
  }
  if (robot.IsDriven(index)) {
    return attributes.Error("the joint '" + name + "' belongs to another group, or to the drive, already");
  }
  if (const CouplingModel* coupling = robot.FindCoupling(index)) {
    return attributes.Error("the joint '" + name + "' follows '" +
                            robot.joints[static_cast<std::size_t>(coupling->leader)].name +
                            "' (<mimic> or gearbox) and has no motor: leave it out, and name the other");
  }
  if (!HasMotor(*found)) {
    attributes.Error("the joint '" + name + "' needs <limit><effort> (N m or N, to " +
                     FormatNumber(kMaxMotorEffort) + ") and <velocity> (rad/s or m/s, to " +
                     FormatNumber(kMaxMotorVelocity) + "), both above 0: its motor's");
  }
  joints.push_back(index);
}

}  // namespace

void CheckModuleName(XmlAttributes& attributes, const std::string& name) {
  const bool good = !name.empty() && name.size() <= 32 && name.front() >= 'a' && name.front() <= 'z' &&
                    name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
  if (!good)
    attributes.Error("a module's name is made of a-z, 0-9 and _, a letter first; not '" + name + "'");
}

void ReadGroup(XmlAttributes& attributes, RobotModel& robot, Diagnostics& diagnostics) {
  attributes.Require("name");
  attributes.Require("joints");
  const std::string name = attributes.Text("name").value_or("");
  const std::string joint_names = attributes.Text("joints").value_or("");
  const std::string profile = attributes.Text("profile").value_or("minimum_jerk");
  BoardModel board;
  board.gravity_compensation = attributes.Flag("gravity_compensation").value_or(false);
  board.encoder_resolution = attributes.Number("encoder_resolution", 0, 1).value_or(0);
  board.encoder_noise_stddev = attributes.Number("encoder_noise_stddev", 0, 1).value_or(0);
  const std::optional<std::string> tool = attributes.Text("tool");
  attributes.Finish();
  if (name.empty() || joint_names.empty()) return;
  CheckModuleName(attributes, name);
  const std::vector<ModuleModel> modules = robot.modules();
  if (std::ranges::find(modules, name, &ModuleModel::name) != modules.end()) {
    attributes.Error("there are two modules '" + name + "': give one another name");
  }
  if (profile == "trapezoidal") {
    board.profile = BoardModel::Profile::kTrapezoidal;
  } else if (profile != "minimum_jerk") {
    attributes.Error("profile is minimum_jerk or trapezoidal, not '" + profile + "'");
  }
  if (tool) {
    const auto frame = std::ranges::find(robot.frames, *tool, &FrameModel::name);
    if (frame == robot.frames.end()) {
      attributes.Error("there is no link '" + *tool + "'" + DidYouMean(*tool, NamesOf(robot.frames)));
    } else {
      board.tool = *frame;
    }
  }
  std::vector<int> joints;
  for (const std::string& joint : SplitWords(joint_names)) AddJoint(attributes, joint, robot, joints);
  if (diagnostics.has_errors()) return;
  robot.actuators.push_back({name, std::move(joints), std::move(board)});
}

void AdoptGroup(XmlAttributes& attributes, RobotModel& robot) {
  std::vector<int> joints;
  for (const std::string& name : SplitWords(attributes.Text("joints").value_or(""))) {
    const auto found = std::ranges::find(robot.joints, name, &JointModel::name);
    const int joint = static_cast<int>(found - robot.joints.begin());
    const bool is_free = found != robot.joints.end() && robot.FindCoupling(joint) == nullptr &&
                         !robot.IsDriven(joint) && HasMotor(*found);
    if (is_free && std::ranges::count(joints, joint) == 0) joints.push_back(joint);
  }
  if (joints.empty()) return;
  std::string module = ModuleName(attributes.Text("name").value_or(""));
  const std::string wanted = module;
  const auto modules = robot.actuator_modules();
  for (int i = 2; module == "joints" || std::ranges::count(modules, module) > 0; ++i)
    module = wanted + "_" + std::to_string(i);
  robot.actuators.push_back({std::move(module), std::move(joints), BoardModel()});
}

void AddDefaultGroup(RobotModel& robot) {
  // Clamp limits that neither the file nor a plugin has set.
  for (JointModel& joint : robot.joints) {
    if (std::isfinite(joint.max_effort)) joint.max_effort = std::min(joint.max_effort, kMaxMotorEffort);
    if (std::isfinite(joint.max_velocity))
      joint.max_velocity = std::min(joint.max_velocity, kMaxMotorVelocity);
  }
  std::vector<int> joints;
  for (int i = 0; i < static_cast<int>(robot.joints.size()); ++i) {
    if (robot.FindCoupling(i) != nullptr) continue;
    if (!robot.IsDriven(i) && HasMotor(robot.joints[static_cast<std::size_t>(i)])) joints.push_back(i);
  }
  if (!joints.empty()) robot.actuators.push_back({"joints", std::move(joints), BoardModel()});
}

}  // namespace coopdyn
