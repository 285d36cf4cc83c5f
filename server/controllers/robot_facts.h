// SPDX-License-Identifier: MIT
// The channels and sensors of a robot, as a controller gets them in create(), and their places in the shared
// area. The stepping thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "clients/plugin/controller.h"
#include "server/base/clock.h"
#include "server/controllers/shared_area.h"
#include "server/model/robot_model.h"
#include "server/model/scenario.h"

namespace coopdyn {

/// Module and name of each joint that is driven, each ends with 0.
std::string JointTexts(const RobotModel& model);
/// The robot's channels, without their texts.
std::vector<coopdyn_joint> JointsOf(const RobotModel& model);

/// Gives the sensors `wanted` (index into the model's) their places.
void PlaceSensors(const RobotModel& model, std::span<const std::size_t> wanted, Layout& in,
                  RobotSetup& setup);
/// Writes what they are to these places.
void WriteSensors(const RobotModel& model, std::span<const std::size_t> wanted, const Areas& areas,
                  const RobotSetup& setup);

/// Gives the robot's channel its places.
void PlaceMapped(const RobotModel& model, Nanoseconds step, Layout& in, Layout& out, RobotSetup& setup);
/// Writes what it is to these places, if there are any.
void WriteMapped(const RobotModel& model, const Areas& areas, const RobotSetup& setup);

/// Gives the names of the options that a scenario gives their place.
void PlaceOptions(const ControllerChoice& choice, Layout& in, RobotSetup& setup);
/// Writes them there, if there is one.
void WriteOptions(const ControllerChoice& choice, const Areas& areas, const RobotSetup& setup);

}  // namespace coopdyn
