// SPDX-License-Identifier: MIT
// Writes the values that clients exchange with a robot as <coopdyn:channel>. Pure; any thread.
#pragma once

#include <functional>
#include <string>

#include "server/rosiml/connect.h"
#include "server/rosiml/experiment.h"
#include "server/rosiml/lines.h"

namespace coopdyn::rosiml {

/// Look-ups of the parts of a written model to which the channel refers. Each returns an empty text if the
/// part is not in this model.
struct ChannelPlaces {
  /// The joint's name.
  std::function<std::string(int joint)> joint;
  /// The muscle's name.
  std::function<std::string(int muscle)> muscle;
  /// The thruster's name.
  std::function<std::string(int thruster)> thruster;
  /// link="…" pose="…" of a place on a body.
  std::function<std::string(int body, const Pose& X_WN)> place;
  /// module="…" index="…" of a sensor.
  std::function<std::string(int sensor)> reading;
  /// The name of the sensor's module.
  std::function<std::string(int sensor)> module;
};

/// The <coopdyn:channel>; empty without exchanged values.
MadeText WriteChannel(const Movable& movable, const ChannelPlaces& places);

}  // namespace coopdyn::rosiml
