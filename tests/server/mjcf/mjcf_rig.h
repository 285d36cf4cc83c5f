// SPDX-License-Identifier: MIT
// MuJoCo files that a test writes as texts, and their models. One thread.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "server/model/sdf_world.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn {

/// <mujoco> with `inside`.
inline std::string Mjcf(const std::string& inside) {
  return "<mujoco model=\"rig\"><compiler autolimits=\"true\"/>\n" + inside + "</mujoco>\n";
}
/// The robot of a file with a free body `base` that contains `inside`, and `rest` beside it in the world
/// body.
inline ForeignAnswer ReadMjcfText(const std::string& inside, const std::string& rest = {}) {
  return ReadAs("rig.xml",
                Mjcf("<worldbody><body name=\"base\" pos=\"0 0 1\"><freejoint/><geom name=\"trunk\" "
                     "type=\"box\" size=\".1 .2 .3\" mass=\"2\"/>" +
                     inside + "</body></worldbody>" + rest));
}
/// A body `name` that hangs on the joint `joint`.
inline std::string Limb(const std::string& name, const std::string& joint) {
  return "<body name=\"" + name + "\" pos=\"0 0 -.3\">" + joint +
         "<geom type=\"capsule\" size=\".02\" fromto=\"0 0 0 0 0 -.2\" mass=\".5\"/></body>";
}
inline const JointModel* JointOf(const ForeignAnswer& answer, const std::string& name) {
  if (answer.robot == nullptr) return nullptr;
  const auto found = std::ranges::find(answer.robot->joints, name, &JointModel::name);
  return found == answer.robot->joints.end() ? nullptr : &*found;
}

struct WorldAnswer {
  std::optional<SdfWorld> world;
  std::string messages;
};
inline WorldAnswer ReadMjcfWorld(const std::string& text) {
  const TempFolder folder;
  folder.Write("rig.xml", text);
  Diagnostics diagnostics;
  WorldAnswer answer;
  answer.world = ReadSdfWorld(folder.path() / "rig.xml", {}, diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}

}  // namespace coopdyn
