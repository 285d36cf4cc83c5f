// SPDX-License-Identifier: MIT
// Makes the devices of robots. Holds the command tables once for all of them. Constant; any thread.
#pragma once

#include <memory>

#include "protocol/command_table.h"
#include "server/devices/device.h"
#include "server/model/robot_model.h"

namespace coopdyn {

class DeviceFactory {
 public:
  DeviceFactory();
  /// The device of `module` of a robot of `model`; null if there is no such type. The factory outlives it.
  std::unique_ptr<Device> Make(const ModuleModel& module, std::shared_ptr<const RobotModel> model) const;

 private:
  const CommandTable motors_, distance_, target_, pose_, neighbours_;
};

}  // namespace coopdyn
