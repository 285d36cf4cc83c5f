// SPDX-License-Identifier: MIT
// Sections of a scenario from what they say: reading them gives the same things to the last bit. Pure; any
// thread.
#pragma once

#include <span>
#include <string>

#include "server/model/scenario.h"

namespace coopdyn {

/// The shortest text that reads as the same number.
std::string ExactNumber(double value);

// Each ends with a line end.
std::string WriteFloor(const Floor& floor);
std::string WriteObject(const WorldObject& object);
std::string WriteLight(const PointLight& light);
/// As [ROBOT_number]. `type`: how the text names its model.
std::string WriteRobot(const RobotEntry& robot, std::size_t number, const std::string& type);
/// One [TARGET]; empty without targets.
std::string WriteTargets(std::span<const Target> targets);
/// `ambient_light` above 0 stands there too.
std::string WriteSimulation(const SimulationOptions& simulation, double ambient_light);

}  // namespace coopdyn
