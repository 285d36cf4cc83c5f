// SPDX-License-Identifier: MIT
// Writes sections of a scenario. Reading them gives bit-identical values. Pure; any thread.
#pragma once

#include <span>
#include <string>

#include "server/model/scenario.h"

namespace coopdyn {

/// The shortest text that reads back as the same number.
std::string ExactNumber(double value);

// Each section ends with a line end.
std::string WriteFloor(const Floor& floor);
std::string WriteObject(const WorldObject& object);
std::string WriteLight(const PointLight& light);
/// Writes [ROBOT_number]. `type`: name of the robot's model in the text.
std::string WriteRobot(const RobotEntry& robot, std::size_t number, const std::string& type);
/// One [TARGET]; empty without targets.
std::string WriteTargets(std::span<const Target> targets);
/// Empty without a task.
std::string WriteTask(const Task& task);
/// Empty if pictures show the whole scene.
std::string WriteView(const View& view);
/// Includes `ambient_light` if above 0.
std::string WriteSimulation(const SimulationOptions& simulation, double ambient_light);

}  // namespace coopdyn
