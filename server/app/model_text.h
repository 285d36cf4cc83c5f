// SPDX-License-Identifier: MIT
// What is in a robot model, in words. Pure; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/geometry/shape.h"
#include "server/model/robot_model.h"

namespace coopdyn {

/// `3 joints`.
std::string CountOf(std::size_t count, const std::string& noun);
/// Counts, mass and size.
std::string SummaryOf(const RobotModel& model);
/// `link cup: its mesh collides as 7 convex parts`, one for each link with meshes that do.
std::vector<std::string> PartTexts(const RobotModel& model);
/// `joint elbow: hinge, from -1 to 1 rad, effort 3 N m, speed 1.5 rad/s`.
std::string JointText(const RobotModel& model, std::size_t joint);
/// `module arm (joints): shoulder, elbow`.
std::string ModuleText(const RobotModel& model, const ModuleModel& module);

/// Those that are no thrusters or limiters, which are kept as joints too.
std::vector<std::size_t> MovingJoints(const RobotModel& model);
/// An actuator with a module drives it.
bool HasMotor(const RobotModel& model, std::size_t joint);
/// Of all that moves, kg.
double MovingMass(const RobotModel& model);
/// Along R's axes, m, in the initial pose: of what collides, or of what is drawn if nothing does.
Vector3 SizeOf(const RobotModel& model);

}  // namespace coopdyn
