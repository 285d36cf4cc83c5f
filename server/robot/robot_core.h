// SPDX-License-Identifier: MIT
// The services that all robots share, and the part that the modules of one robot share: its place in a frame,
// its devices, its inbox of steps.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/wrong_tokens.h"
#include "server/devices/connection_roster.h"
#include "server/devices/device.h"
#include "server/devices/step_inbox.h"
#include "server/naming/name_table.h"
#include "server/net/net_services.h"
#include "server/state/command_board.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/image_board.h"
#include "server/yarp/yarp_ports.h"
#include "server/yars/udp_port.h"

namespace coopdyn {

/// The services of all robots of one daemon. Constant; any thread. All referenced objects outlive the robots.
struct RobotServices {
  CommandBoard& board;
  const FrameBoard& frames;
  EditQueue& edits;
  ImageBoard& images;
  NameTable& names;
  NetServices& net;
  ConnectionRoster& roster;
  const TokenGuard& guard;  // requires the token with `--private`
  const Clock& clock;
  std::string version;
  YarsPorts* yars = nullptr;  // null: no UDP ports for clients of YARS
  YarpPorts* yarp = nullptr;  // null: no ports of YARP
};

/// Used only on the robot's thread, or in its turn, once built.
class RobotCore {
 public:
  /// `post` and `hand_over` run a function on the robot's thread: see StepInbox.
  RobotCore(const RobotEntry& entry, const RobotServices& services, StepInbox::Post post,
            const StepInbox::Post& hand_over);

  const std::string& name() const { return name_; }
  const RobotModel& model() const { return *model_; }
  /// True if the robot is of this model: scenarios may have different models of the same type name.
  bool Is(const RobotModel& model) const {
    return &model == model_.get() || (model.type == model_->type && model.text == model_->text);
  }
  const RobotServices& services() const { return services_; }
  StepInbox& inbox() { return inbox_; }
  /// The devices in the model's order, and their names.
  const std::vector<std::unique_ptr<Device>>& devices() const { return devices_; }
  const std::vector<std::string>& module_names() const { return module_names_; }
  /// The robot's index in the scene of `frame`, found by name, because ids may change with a load; -1: not in
  /// the scene.
  int IndexIn(const Frame& frame);

 private:
  const std::string name_;
  const std::shared_ptr<const RobotModel> model_;  // used by the devices
  const RobotServices& services_;
  std::vector<std::unique_ptr<Device>> devices_;
  std::vector<std::string> module_names_;
  std::shared_ptr<const Scene> scene_;  // scene of index_
  int index_ = -1;
  StepInbox inbox_;
};

}  // namespace coopdyn
