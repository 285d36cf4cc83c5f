// SPDX-License-Identifier: MIT
// Short descriptions of sensors. Any thread.
#pragma once

#include <string>

#include "server/model/robot_model.h"

namespace coopdyn {

/// A short description of a sensor of `robot`, e.g. "360 rays, 0.12 to 3.5 m, 5 Hz"; may be empty.
std::string Describe(const SensorModel& sensor, const RobotModel& robot);

// Parts of such texts.
std::string Span(double min_m, double max_m);
std::string On(const Mount& mount, const RobotModel& robot);

}  // namespace coopdyn
