// SPDX-License-Identifier: MIT
#include "server/devices/device_factory.h"

#include <utility>

#include "protocol/module_tables.h"
#include "server/devices/distance.h"
#include "server/devices/motors.h"
#include "server/devices/neighbours.h"
#include "server/devices/pose.h"
#include "server/devices/target.h"

namespace coopdyn {

DeviceFactory::DeviceFactory()
    : motors_(MotorsTable()),
      distance_(DistanceTable()),
      target_(TargetTable()),
      pose_(PoseTable()),
      neighbours_(NeighboursTable()) {}

std::unique_ptr<Device> DeviceFactory::Make(const ModuleModel& module,
                                            std::shared_ptr<const RobotModel> model) const {
  if (module.type == "motors") {
    const ActuatorModel& drive = *model->drive_actuator();
    return std::make_unique<MotorsDevice>(motors_, *model->drive(), model->FirstChannel(drive));
  }
  if (module.type == "distance") return std::make_unique<DistanceDevice>(distance_, std::move(model));
  if (module.type == "target") return std::make_unique<TargetDevice>(target_);
  if (module.type == "pose") return std::make_unique<PoseDevice>(pose_);
  if (module.type == "neighbours") return std::make_unique<NeighboursDevice>(neighbours_, std::move(model));
  return nullptr;
}

}  // namespace coopdyn
