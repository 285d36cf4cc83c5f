// SPDX-License-Identifier: MIT
// Explains why it matters, or not, that coopdyn leaves out some element of a model. Pure; any thread.
#pragma once

#include <string>

#include "server/base/diagnostics.h"
#include "server/model/robot_model.h"

namespace coopdyn {

struct Consequence {
  bool matters = true;  // the model moves, senses or is driven differently
  std::string why;      // half a sentence; empty if the warning says it already
};

/// The consequence of a warning. `robot`: the model as read; null for a world.
Consequence ConsequenceOf(const Diagnostic& warning, const RobotModel* robot);
/// The consequence of leaving out `what`, e.g. "<gravity> in <link>" or "plug-in 'libgazebo_ros_imu.so'".
Consequence ConsequenceOf(const std::string& what, const RobotModel* robot);

}  // namespace coopdyn
