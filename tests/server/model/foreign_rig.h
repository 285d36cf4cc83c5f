// SPDX-License-Identifier: MIT
// Models of other programs that a test writes as texts, and the readers' results. One thread.
#pragma once

#include <memory>
#include <string>

#include "tests/server/model/read_text.h"

namespace coopdyn {

struct ForeignAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

inline ForeignAnswer ReadFile(const TempFolder& folder, const std::string& name,
                              const SearchPath& path = {}) {
  Diagnostics diagnostics;
  ForeignAnswer answer;
  answer.robot = ReadRobotModel(folder.path() / name, path, diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}
inline ForeignAnswer ReadAs(const std::string& name, const std::string& text) {
  const TempFolder folder;
  folder.Write(name, text);
  return ReadFile(folder, name);
}
inline ForeignAnswer ReadUrdf(const std::string& inside) {
  return ReadAs("rig.urdf", "<robot name=\"rig\">\n" + inside + "</robot>");
}
inline ForeignAnswer ReadSdf(const std::string& inside, const std::string& version = "1.6") {
  return ReadAs("model.sdf",
                "<sdf version=\"" + version + "\"><model name=\"rig\">\n" + inside + "</model></sdf>");
}

inline std::string SdfLink(const std::string& name, const std::string& pose, const std::string& geometry) {
  return "<link name=\"" + name + "\"><pose>" + pose +
         "</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></"
         "inertial>\n"
         "<collision name=\"c\"><geometry>" +
         geometry + "</geometry></collision></link>\n";
}
inline const std::string kSdfBox = "<box><size>0.2 0.2 0.2</size></box>";

}  // namespace coopdyn
