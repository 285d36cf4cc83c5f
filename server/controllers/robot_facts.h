// SPDX-License-Identifier: MIT
// A robot's channels and sensors, as passed to a controller's create(), and their places in the shared area.
// Stepping thread.
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

/// Module and name of each driven joint, each ending with 0.
std::string JointTexts(const RobotModel& model);
/// The robot's channels, without their texts.
std::vector<coopdyn_joint> JointsOf(const RobotModel& model);

/// Allocates the places of the sensors `wanted` (indices into the model's sensors).
void PlaceSensors(const RobotModel& model, std::span<const std::size_t> wanted, Layout& in,
                  RobotSetup& setup);
/// Writes the sensors' facts to these places.
void WriteSensors(const RobotModel& model, std::span<const std::size_t> wanted, const Areas& areas,
                  const RobotSetup& setup);

/// Allocates the places of the robot's channel.
void PlaceMapped(const RobotModel& model, Nanoseconds step, Layout& in, Layout& out, RobotSetup& setup);
/// Writes the channel's facts to these places, if there are any.
void WriteMapped(const RobotModel& model, const Areas& areas, const RobotSetup& setup);

/// Allocates the place for the names of the scenario's options.
void PlaceOptions(const ControllerChoice& choice, Layout& in, RobotSetup& setup);
/// Writes the names to this place, if there is one.
void WriteOptions(const ControllerChoice& choice, const Areas& areas, const RobotSetup& setup);

}  // namespace coopdyn
