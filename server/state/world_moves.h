// SPDX-License-Identifier: MIT
// Looks up ids of /world, describes things in their present state, and makes changes that move them. Pure
// functions; any thread.
#pragma once

#include <cstdint>
#include <string>

#include "server/state/world_change.h"

namespace coopdyn {

/// The thing with an id: an index into the scene; all -1: none.
struct Found {
  int object = -1, robot = -1, target = -1, light = -1;
  bool any() const { return object >= 0 || robot >= 0 || target >= 0 || light >= 0; }
};
Found FindId(const Scene& scene, std::int32_t id);

inline const SceneObject& ObjectAt(const Scene& scene, int place) {
  return scene.objects[static_cast<std::size_t>(place)];
}
inline const SceneRobot& RobotAt(const Scene& scene, int place) {
  return scene.robots[static_cast<std::size_t>(place)];
}

/// A thing's description with its present pose and motion; the pose of an unmoved thing is bit-identical.
WorldObject ObjectNow(const Frame& frame, const SceneObject& thing);
RobotEntry RobotNow(const Frame& frame, int place);

/// Adds to `change` a move of `found` to rest at `X_W`, the pose of its frame in the world; for a target or
/// light only the position counts. Returns its name. @pre found.any(), and `change` does not contain it yet
std::string AddMove(const Frame& frame, const Found& found, const Pose& X_W, WorldChange& change);

}  // namespace coopdyn
