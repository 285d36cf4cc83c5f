// SPDX-License-Identifier: MIT
// What an id of /world means, its description as it stands now, and the change that puts it elsewhere. Pure
// functions; any thread.
#pragma once

#include <cstdint>
#include <string>

#include "server/state/world_change.h"

namespace coopdyn {

/// What a name or an id means: indices into the scene; all -1: nothing.
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

/// The description of a thing with its present place and motion; one that was not moved has the very numbers
/// of its place that it had.
WorldObject ObjectNow(const Frame& frame, const SceneObject& thing);
RobotEntry RobotNow(const Frame& frame, int place);

/// Adds to `change` that `found` comes to rest at `X_W`, the pose of its frame in the world; of a target and
/// a light only the place counts. Returns its name. @pre found.any(), and it is not in `change` yet
std::string AddMove(const Frame& frame, const Found& found, const Pose& X_W, WorldChange& change);

}  // namespace coopdyn
