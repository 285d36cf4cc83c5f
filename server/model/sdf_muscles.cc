// SPDX-License-Identifier: MIT
// Reads `<coopdyn:muscle>`.
#include <tinyxml2.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// A link of the model and a point on it, in R.
struct MuscleEnd {
  int link = 0;
  Vector3 p_R;
};

std::optional<MuscleEnd> FindMuscleEnd(XmlAttributes& attributes, const std::string& key,
                                       const RobotModel& robot) {
  attributes.Require(key);
  const std::optional<std::string> name = attributes.Text(key);
  Vector3 point = Vector3::Zero();
  if (const auto numbers = attributes.Numbers(key + "_point", 3))
    point = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  if (!name) return std::nullopt;
  constexpr double kFar_m = 1e4;
  if (point.norm() > kFar_m) attributes.Error("'" + key + "_point' is more than 10 km away");
  const auto frame = std::ranges::find(robot.frames, *name, &FrameModel::name);
  if (frame != robot.frames.end()) return MuscleEnd{frame->link, frame->X_RF * point};
  if (*name == "world") {
    if (robot.fixed_base) return MuscleEnd{0, point};
    attributes.Error("only a robot that is fixed to the world has muscles to 'world'");
    return std::nullopt;
  }
  std::vector<std::string> names;
  for (const FrameModel& one : robot.frames) names.push_back(one.name);
  attributes.Error("there is no link '" + *name + "'" + DidYouMean(*name, names));
  return std::nullopt;
}

}  // namespace

std::vector<std::pair<int, int>> TiesOf(const tinyxml2::XMLElement& model, const RobotModel& robot) {
  std::vector<std::pair<int, int>> ties;
  for (const auto* muscle = model.FirstChildElement("coopdyn:muscle"); muscle != nullptr;
       muscle = muscle->NextSiblingElement("coopdyn:muscle")) {
    const char *from = muscle->Attribute("from"), *to = muscle->Attribute("to");
    if (from == nullptr || to == nullptr) continue;
    const auto a = std::ranges::find(robot.links, from, &LinkModel::name),
               b = std::ranges::find(robot.links, to, &LinkModel::name);
    if (a != robot.links.end() && b != robot.links.end())
      ties.emplace_back(static_cast<int>(a - robot.links.begin()), static_cast<int>(b - robot.links.begin()));
  }
  return ties;
}

void ReadMuscle(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics) {
  XmlAttributes attributes(element, file, diagnostics);
  for (const char* needed : {"name", "max_force_n", "optimal_length_m"}) attributes.Require(needed);
  JointModel joint;
  joint.kind = JointModel::Kind::kMuscle;
  joint.name = attributes.Text("name").value_or("");
  joint.max_velocity = joint.max_effort = 0;
  MuscleModel muscle;
  const std::optional<MuscleEnd> from = FindMuscleEnd(attributes, "from", robot),
                                 to = FindMuscleEnd(attributes, "to", robot);
  const auto number = [&attributes](const char* name, double least, double most, double& value) {
    value = attributes.Number(name, least, most).value_or(value);
  };
  constexpr double kLeast = 1e-6, kMost = 1e6;
  muscle.max_force_n = attributes.Number("max_force_n", 0, kMost).value_or(1);
  muscle.optimal_length_m = attributes.Number("optimal_length_m", kLeast, kMost).value_or(1);
  number("width", kLeast, kMost, muscle.width);
  number("c", 0, kMost, muscle.c);
  number("eccentric", 1, kMost, muscle.eccentric);
  number("curvature", kLeast, kMost, muscle.curvature);
  muscle.use_length = attributes.Flag("use_length").value_or(true);
  muscle.use_velocity = attributes.Flag("use_velocity").value_or(true);
  if (muscle.use_velocity) attributes.Require("max_velocity_m_s");
  muscle.max_velocity_m_s = attributes.Number("max_velocity_m_s", kLeast, kMost).value_or(1);
  attributes.Finish();
  if (!from || !to) return;
  if (from->link == to->link) {
    attributes.Error("'from' and 'to' are one body: a muscle joins two that move against each other");
    return;
  }
  muscle.p_from_R = from->p_R;
  muscle.p_to_R = to->p_R;
  joint.parent = from->link;
  joint.child = to->link;
  joint.p_RJ = from->p_R;
  joint.max_effort = muscle.max_force_n;
  joint.max_velocity = muscle.use_velocity ? muscle.max_velocity_m_s : JointModel::kInfinity;
  joint.muscle = muscle;
  AddToModule(attributes, std::move(joint), MusclesModel(), "muscles", robot);
}

void AddToModule(XmlAttributes& attributes, JointModel joint, const decltype(ActuatorModel::kind)& kind,
                 const std::string& module, RobotModel& robot) {
  if (joint.name.empty()) attributes.Error("'name' is empty: give it one");
  if (std::ranges::find(robot.joints, joint.name, &JointModel::name) != robot.joints.end())
    attributes.Error("there is another joint, muscle or thruster '" + joint.name +
                     "': give one another name");
  const auto is_of_kind = [&kind](const ActuatorModel& one) { return one.kind.index() == kind.index(); };
  if (std::ranges::none_of(robot.actuators, is_of_kind)) {
    const std::vector<ModuleModel> modules = robot.modules();
    if (std::ranges::find(modules, module, &ModuleModel::name) != modules.end())
      attributes.Error("the module of its " + module + " is called '" + module +
                       "': give the other one another name");
    robot.actuators.push_back({module, {}, kind});
  }
  std::ranges::find_if(robot.actuators, is_of_kind)->joints.push_back(static_cast<int>(robot.joints.size()));
  robot.joints.push_back(std::move(joint));
}

}  // namespace coopdyn
