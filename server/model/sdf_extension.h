// SPDX-License-Identifier: MIT
// Our own elements in a robot's SDF, namespace `coopdyn:` (docs/formats.md): drive, distance and target
// sensors, modules, and which visuals take the robot's colour.
#pragma once

#include <span>
#include <string>

#include "server/base/diagnostics.h"
#include "server/model/robot_model.h"

namespace tinyxml2 {
class XMLElement;
}

namespace coopdyn {

/// Whether `visual` (`<visual>`) says coopdyn:color="robot". Another value is an error.
bool TakesRobotColor(const tinyxml2::XMLElement& visual, const std::string& file, Diagnostics& diagnostics);

/// Reads our elements in `model` (`<model>`) into `robot`, whose links and joints are complete.
/// `max_speeds_rad_s`: of each joint, as its `<limit><velocity>` says.
void ReadExtension(const tinyxml2::XMLElement& model, const std::string& file,
                   std::span<const double> max_speeds_rad_s, RobotModel& robot, Diagnostics& diagnostics);

}  // namespace coopdyn
