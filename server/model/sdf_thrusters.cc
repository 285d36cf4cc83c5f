// SPDX-License-Identifier: MIT
// Reads `<coopdyn:thruster>`, and the rotors of Gazebo's plugins.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kMostReaction_m = 1e3;

}  // namespace

void ReadThruster(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                  Diagnostics& diagnostics) {
  XmlAttributes attributes(element, file, diagnostics);
  for (const char* needed : {"name", "link", "direction"}) attributes.Require(needed);
  JointModel joint;
  joint.name = attributes.Text("name").value_or("");
  const std::string link = attributes.Text("link").value_or("");
  const auto direction = attributes.Numbers("direction", 3), point = attributes.Numbers("point", 3);
  constexpr double kMost = 1e6;
  const auto force_n = attributes.Number("max_force_n", 0, kMost),
             torque_nm = attributes.Number("max_torque_nm", 0, kMost);
  const auto reaction_m = attributes.Number("torque_per_force_m", -kMostReaction_m, kMostReaction_m);
  attributes.Finish();
  if (element.Attribute("max_force_n") != nullptr && element.Attribute("max_torque_nm") != nullptr) {
    attributes.Error("a thruster has 'max_force_n' or 'max_torque_nm', not both: write two thrusters");
  } else if (element.Attribute("max_force_n") == nullptr && element.Attribute("max_torque_nm") == nullptr) {
    attributes.Error("a thruster needs 'max_force_n' or 'max_torque_nm'");
  }
  if (torque_nm && reaction_m)
    attributes.Error("'torque_per_force_m' is of a force, a propeller's: write 'max_force_n'");
  if (torque_nm && point) attributes.Error("a torque has no 'point': it is the same at all points");
  const Vector3 axis =
      direction ? Vector3((*direction)[0], (*direction)[1], (*direction)[2]) : Vector3::Zero();
  constexpr double kNothing = 1e-9, kFar_m = 1e4;
  if (direction && !(axis.norm() > kNothing)) attributes.Error("'direction' has no length: write 1 0 0, say");
  const auto frame = std::ranges::find(robot.frames, link, &FrameModel::name);
  if (frame == robot.frames.end()) {
    std::vector<std::string> names;
    for (const FrameModel& one : robot.frames) names.push_back(one.name);
    if (!link.empty()) attributes.Error("there is no link '" + link + "'" + DidYouMean(link, names));
    return;
  }
  const auto body = static_cast<std::size_t>(frame->link);
  joint.kind = torque_nm ? JointModel::Kind::kTorque : JointModel::Kind::kForce;
  joint.parent = joint.child = frame->link;
  joint.axis_R = frame->X_RF.q * axis.normalized();
  joint.p_RJ = (robot.links[body].X_RL * robot.links[body].X_LI).p;
  if (point) {
    const Vector3 p_F((*point)[0], (*point)[1], (*point)[2]);
    if (p_F.norm() > kFar_m) attributes.Error("'point' is more than 10 km away");
    joint.p_RJ = frame->X_RF * p_F;
  }
  joint.max_effort = force_n.value_or(torque_nm.value_or(0));
  joint.torque_per_force_m = reaction_m.value_or(0);
  AddToModule(attributes, std::move(joint), ThrustersModel(), "thrusters", robot);
}

void AdoptRotor(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics) {
  XmlAttributes attributes(element, file, diagnostics);
  const std::string joint_name = attributes.Text("joint").value_or("");
  const std::string link_name = attributes.Text("link").value_or("");
  const auto given = std::ranges::find(robot.joints, joint_name, &JointModel::name);
  const bool turns = given != robot.joints.end() && given->has_axis();
  // The thrust is along z of its link, else along the axis of its joint.
  const std::string carrier =
      link_name.empty() && turns ? robot.links[static_cast<std::size_t>(given->child)].name : link_name;
  const auto frame = std::ranges::find(robot.frames, carrier, &FrameModel::name);
  constexpr double kMost_n = 1e6;
  const double force_n = ParsePlain(attributes.Text("max_force_n").value_or("")).value_or(0);
  const double reaction_m = ParsePlain(attributes.Text("torque_per_force_m").value_or("")).value_or(0);
  const auto leave = [&](const std::string& why) {
    diagnostics.Warning(
        attributes.where(),
        "the thruster of '" + (joint_name.empty() ? link_name : joint_name) + "' is left out, since " + why);
  };
  if (frame == robot.frames.end()) return leave("the model has no such link or turning joint");
  if (!(force_n > 0 && force_n <= kMost_n) || std::abs(reaction_m) > kMostReaction_m)
    return leave("its greatest thrust is not between 0 and 1e6 N, or its moment beyond 1000 N m per N");
  JointModel thruster;
  thruster.kind = JointModel::Kind::kForce;
  // Push the rotor's holder, which is equivalent because the force is along the rotor's axis.
  thruster.parent = thruster.child = turns ? given->parent : frame->link;
  thruster.axis_R = link_name.empty() ? given->axis_R : Vector3(frame->X_RF.q * Vector3::UnitZ());
  thruster.p_RJ = frame->X_RF.p;
  thruster.max_effort = force_n;
  thruster.torque_per_force_m = reaction_m;
  thruster.name = carrier;
  while (std::ranges::count(robot.joints, thruster.name, &JointModel::name) > 0) thruster.name += "_thrust";
  // The propeller turns freely: disable its motor.
  if (turns && !robot.IsDriven(static_cast<int>(given - robot.joints.begin()))) given->max_effort = 0;
  AddToModule(attributes, std::move(thruster), ThrustersModel(), "thrusters", robot);
}

}  // namespace coopdyn
