// SPDX-License-Identifier: MIT
// Sensors of models built by tests.
#pragma once

#include "server/model/robot_model.h"

namespace coopdyn {

/// The first sensor of a kind, for changes. Added if the model has none, with its type as its module's name.
template <typename Kind>
Kind& SensorOf(RobotModel& model) {
  if (model.Find<Kind>() == nullptr) model.AddSensor(Kind::kType, Kind());
  return const_cast<Kind&>(*model.Find<Kind>());
}

}  // namespace coopdyn
