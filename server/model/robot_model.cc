// SPDX-License-Identifier: MIT
#include "server/model/robot_model.h"

namespace coopdyn {

std::vector<std::string> RobotModel::actuator_modules() const {
  std::vector<std::string> names;
  for (const ActuatorModel& actuator : actuators) {
    if (!actuator.module.empty()) names.push_back(actuator.module);
  }
  return names;
}

std::size_t RobotModel::FirstChannel(const ActuatorModel& actuator) const {
  std::size_t first = 0;
  for (const ActuatorModel* before = actuators.data(); before != &actuator; ++before)
    first += before->joints.size();
  return first;
}

const ActuatorModel* RobotModel::drive_actuator() const {
  for (const ActuatorModel& actuator : actuators) {
    if (std::holds_alternative<DriveModel>(actuator.kind)) return &actuator;
  }
  return nullptr;
}

}  // namespace coopdyn
