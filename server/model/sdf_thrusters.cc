// SPDX-License-Identifier: MIT
// `<coopdyn:thruster>`.
#include <tinyxml2.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

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
  attributes.Finish();
  if (element.Attribute("max_force_n") != nullptr && element.Attribute("max_torque_nm") != nullptr) {
    attributes.Error("a thruster has 'max_force_n' or 'max_torque_nm', not both: write two thrusters");
  } else if (element.Attribute("max_force_n") == nullptr && element.Attribute("max_torque_nm") == nullptr) {
    attributes.Error("a thruster needs 'max_force_n' or 'max_torque_nm'");
  }
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
  AddToModule(attributes, std::move(joint), ThrustersModel(), "thrusters", robot);
}

}  // namespace coopdyn
