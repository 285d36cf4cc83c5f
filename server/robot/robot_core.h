// SPDX-License-Identifier: MIT
// What the modules of one robot share: its place in a frame, its devices, the inbox of
// steps. The robot's thread only, once it is built.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/devices/device.h"
#include "server/devices/step_inbox.h"
#include "server/robot/robot_services.h"

namespace coopdyn {

class RobotCore {
 public:
  /// `post`: runs a function on the robot's thread, as StepInbox says.
  RobotCore(const RobotEntry& entry, const RobotServices& services, StepInbox::Post post);

  const std::string& name() const { return name_; }
  const std::string& type() const { return type_; }
  const RobotServices& services() const { return services_; }
  StepInbox& inbox() { return inbox_; }
  /// In the model's order, and their names.
  const std::vector<std::unique_ptr<Device>>& devices() const { return devices_; }
  const std::vector<std::string>& module_names() const { return module_names_; }
  /// The robot's index in the scene of `frame`, found by its name, since ids may change with a load; -1: not
  /// there.
  int IndexIn(const Frame& frame);

 private:
  const std::string name_, type_;
  const RobotServices& services_;
  std::vector<std::unique_ptr<Device>> devices_;
  std::vector<std::string> module_names_;
  std::shared_ptr<const Scene> scene_;  // in which index_ holds
  int index_ = -1;
  StepInbox inbox_;
};

}  // namespace coopdyn
