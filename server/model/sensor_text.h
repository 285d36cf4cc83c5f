// SPDX-License-Identifier: MIT
// Sensors in a few words. Any thread.
#pragma once

#include <string>

#include "server/model/robot_model.h"

namespace coopdyn {

/// What a sensor of `robot` is like, for example "360 rays, 0.12 to 3.5 m, 5 Hz"; empty if there is nothing
/// to say.
std::string Describe(const SensorModel& sensor, const RobotModel& robot);

}  // namespace coopdyn
