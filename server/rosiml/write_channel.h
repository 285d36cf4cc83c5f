// SPDX-License-Identifier: MIT
// What clients exchange with a robot, as <coopdyn:channel>. Pure; any thread.
#pragma once

#include <functional>
#include <string>

#include "server/rosiml/connect.h"
#include "server/rosiml/experiment.h"
#include "server/rosiml/lines.h"

namespace coopdyn::rosiml {

/// Where the writer of a model has put what the channel names.
struct ChannelPlaces {
  /// name of a joint; empty: it is not in this model.
  std::function<std::string(int joint)> joint;
  /// likewise of a muscle, of a thruster.
  std::function<std::string(int muscle)> muscle;
  std::function<std::string(int thruster)> thruster;
  /// link="…" pose="…" of a place on a body; empty: it is not in this model.
  std::function<std::string(int body, const Pose& X_WN)> place;
  /// module="…" index="…" of a sensor; empty: likewise.
  std::function<std::string(int sensor)> reading;
  /// name of its module.
  std::function<std::string(int sensor)> module;
};

/// Empty if there is nothing to exchange.
MadeText WriteChannel(const Movable& movable, const ChannelPlaces& places);

}  // namespace coopdyn::rosiml
