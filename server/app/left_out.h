// SPDX-License-Identifier: MIT
// Why it matters that coopdyn leaves something of a model out, or why it does not. Pure; any thread.
#pragma once

#include <string>

#include "server/base/diagnostics.h"
#include "server/model/robot_model.h"

namespace coopdyn {

struct Consequence {
  bool matters = true;  // it moves, senses or is driven other than it was meant
  std::string why;      // half a sentence; may be empty if it was said already
};

/// Of a warning. `robot`: what was read of the model, null if it is a world.
Consequence ConsequenceOf(const Diagnostic& warning, const RobotModel* robot);
/// Of its `what`, as "<gravity> in <link>" or "plug-in 'libgazebo_ros_imu.so'".
Consequence ConsequenceOf(const std::string& what, const RobotModel* robot);

}  // namespace coopdyn
