// SPDX-License-Identifier: MIT
// Turns bodies and joints into coopdyn's models: a tree with a base, its frame on the floor, and two wheels
// that form a drive. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/rosiml/experiment.h"

namespace coopdyn::rosiml {

/// A connected set of bodies.
struct Model {
  /// A joint of the movable, directed away from the base.
  struct Link {
    int joint = 0;                          // index into Movable::joints
    int parent = Joint::kWorld, child = 0;  // index into Movable::bodies
    bool is_turned = false;                 // reverse the axis, so that positions have the right sign
  };

  std::vector<int> bodies;  // the base first
  std::vector<Link> links;
  std::vector<int> still;                    // bodies fixed to the world
  std::optional<std::array<int, 2>> wheels;  // left and right, index into `links`
  std::vector<bool> is_base;                 // for each body of the movable: fixed joints hold it to the base
  Pose X_WR;                                 // the robot's frame: x forward, z up, origin on the floor
  double lift_m = 0;                         // height added to the file's pose
};

/// Returns the models of `movable`, that of the first body first. Lifts a model that stands in the ground
/// onto it, with a warning.
std::vector<Model> Connect(const Movable& movable, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
