// SPDX-License-Identifier: MIT
#include "server/robot/robot_core.h"

#include <utility>

namespace coopdyn {

RobotCore::RobotCore(const RobotEntry& entry, const RobotServices& services, StepInbox::Post post,
                     StepInbox::Post hand_over)
    : name_(entry.name),
      type_(entry.model->type),
      services_(services),
      inbox_(services.board, services.frames, std::move(post), std::move(hand_over)) {
  for (const ModuleModel& module : entry.model->modules()) {
    devices_.push_back(MakeDevice(*entry.model, module.name));
    module_names_.push_back(module.name);
  }
}

int RobotCore::IndexIn(const Frame& frame) {
  if (frame.scene != scene_) {
    scene_ = frame.scene;
    index_ = scene_->FindRobot(name_);
    if (index_ >= 0 && scene_->robots[static_cast<std::size_t>(index_)].entry.model->type != type_)
      index_ = -1;
  }
  return index_;
}

}  // namespace coopdyn
