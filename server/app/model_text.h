// SPDX-License-Identifier: MIT
// Describes the contents of a robot model in words. Pure; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/geometry/shape.h"
#include "server/model/robot_model.h"

namespace coopdyn {

/// Counts, mass and size.
std::string SummaryOf(const RobotModel& model);
/// `link cup: its mesh collides as 7 convex parts`, one line per link with such meshes.
std::vector<std::string> PartTexts(const RobotModel& model);
/// `joint elbow: hinge, from -1 to 1 rad, effort 3 N m, speed 1.5 rad/s`.
std::string JointText(const RobotModel& model, std::size_t joint);
/// `module arm (joints): shoulder, elbow`.
std::string ModuleText(const RobotModel& model, const ModuleModel& module);

/// The joints without thrusters and limiters, which are stored as joints too.
std::vector<std::size_t> MovingJoints(const RobotModel& model);
/// Whether an actuator with a module drives the joint.
bool HasMotor(const RobotModel& model, std::size_t joint);
/// Mass of all moving links, kg.
double MovingMass(const RobotModel& model);
/// Size along R's axes, m, in the initial pose: of the collisions, or of the visuals if there are none.
Vector3 SizeOf(const RobotModel& model);

}  // namespace coopdyn
