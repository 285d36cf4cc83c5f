// SPDX-License-Identifier: MIT
#include "server/model/robot_model.h"

#include <algorithm>

namespace coopdyn {

bool RobotModel::has_actuators() const {
  return std::any_of(modules.begin(), modules.end(),
                     [](const ModuleModel& module) { return module.type == "motors"; });
}

}  // namespace coopdyn
