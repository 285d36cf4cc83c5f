// SPDX-License-Identifier: MIT
// From bodies and joints to robots as coopdyn has them: a tree with a base, its frame on the floor, and two
// wheels that make a drive. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/rosiml/experiment.h"

namespace coopdyn::rosiml {

/// Bodies that hang together.
struct Model {
  /// A joint of the movable, from the body nearer to the base to the other.
  struct Link {
    int joint = 0;
    int parent = Joint::kWorld, child = 0;  // index into Movable::bodies
    bool is_turned = false;  // its axis points the other way, so that positions count as they should
  };

  std::vector<int> bodies;  // the base first
  std::vector<Link> links;
  std::vector<int> still;                    // bodies that are fixed to the world
  std::optional<std::array<int, 2>> wheels;  // left and right, index into `links`
  std::vector<bool> is_base;                 // of each body of the movable: fixed joints hold it to the base
  Pose X_WR;                                 // of the robot's frame: x forward, z up, its origin on the floor
  double lift_m = 0;                         // it stands so much higher than the file says
};

/// The first is that of the first body, or of the drive. What stands in the floor is lifted onto it, and
/// said.
std::vector<Model> Connect(const Movable& movable, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
