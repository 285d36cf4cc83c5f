// SPDX-License-Identifier: MIT
// Makes the devices of robots. Holds the command tables once for all of them. Constant; any thread.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "protocol/command_table.h"
#include "server/devices/device.h"
#include "server/model/robot_model.h"

namespace coopdyn {

class DeviceFactory {
 public:
  DeviceFactory();
  /// The device of the module `name` of robots of `model`; null if they have none. The factory outlives it.
  std::unique_ptr<Device> Make(const RobotModel& model, std::string_view name) const;

 private:
  const CommandTable& TableOf(std::string_view type) const;

  const std::vector<CommandTable> tables_;
};

}  // namespace coopdyn
