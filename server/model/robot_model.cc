// SPDX-License-Identifier: MIT
#include "server/model/robot_model.h"

namespace coopdyn {

std::vector<std::string> RobotModel::actuator_modules() const {
  std::vector<std::string> names;
  for (const ModuleModel& module : modules) {
    if (module.type == "motors") names.push_back(module.name);
  }
  return names;
}

}  // namespace coopdyn
