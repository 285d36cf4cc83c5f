// SPDX-License-Identifier: MIT
// A robot of four links for tests of sensor elements, and the reader's results.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>

#include "tests/server/model/read_text.h"

namespace coopdyn::sensor_rig {

inline constexpr double kPerDegree = std::numbers::pi / 180;

struct ElementAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

inline std::string RigLink(const std::string& name, const std::string& pose, double mass_kg,
                           const std::string& more = "") {
  const std::string moment = std::to_string(0.01 * mass_kg);
  return "<link name=\"" + name + "\"><pose>" + pose + "</pose><inertial><mass>" + std::to_string(mass_kg) +
         "</mass><inertia><ixx>" + moment + "</ixx><iyy>" + moment + "</iyy><izz>" + moment +
         "</izz></inertia></inertial><collision name=\"body\"><geometry><box><size>0.1 0.1 "
         "0.1</size></box></geometry>"
         "</collision>" +
         more + "</link>\n";
}
inline std::string RigJoint(const std::string& name, const std::string& type, const std::string& parent,
                            const std::string& child) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent>" + parent + "</parent><child>" + child +
         "</child>" +
         (type == "fixed"
              ? ""
              : "<axis><xyz>0 0 1</xyz><limit><effort>1</effort><velocity>1</velocity></limit></axis>") +
         "</joint>\n";
}

/// A base, an arm that turns on it, a hand fixed to the arm and a finger that turns on the hand. `elements`
/// start at line 9.
inline ElementAnswer ReadRig(const std::string& elements) {
  const std::string text =
      "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">\n" +
      RigLink("base", "0 0 0.05 0 0 0", 4) + RigLink("arm", "0.2 0 0.5 0 0 0", 2) +
      RigLink("hand", "0.5 0 0.5 0 0 1.5707963267948966", 1) + RigLink("finger", "0.7 0 0.5 0 0 0", 0.5) +
      RigJoint("shoulder", "revolute", "base", "arm") + RigJoint("weld", "fixed", "arm", "hand") +
      RigJoint("knuckle", "revolute", "hand", "finger") + elements + "</model></sdf>";
  Diagnostics diagnostics;
  ElementAnswer answer;
  answer.robot = ReadRobotModelText(text, "rig.sdf", "rig", diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}
inline std::string ModuleOf(const std::string& type) {
  return "<coopdyn:module type=\"" + type + "\"/>\n";
}

template <typename Kind>
Kind Described(const std::string& element) {
  const ElementAnswer answer = ReadRig(element + "\n" + ModuleOf(Kind::kType));
  EXPECT_EQ(answer.messages, "");
  if (answer.robot == nullptr || answer.robot->Find<Kind>() == nullptr) return {};
  return *answer.robot->Find<Kind>();
}
inline std::string WrongElement(const std::string& type, const std::string& element) {
  return ReadRig(element + "\n" + ModuleOf(type)).messages;
}

}  // namespace coopdyn::sensor_rig
