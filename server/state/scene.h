// SPDX-License-Identifier: MIT
// What stands in the world now: the scenario's things with their places in a frame. Immutable once published;
// a world edit makes a new one. Any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/model/scenario.h"
#include "server/state/scene_cache.h"

namespace coopdyn {

struct SceneObject {
  ObjectId id;
  WorldObject object;
  int body = -1;  // index into Frame::bodies; -1: static
};

struct SceneRobot {
  RobotId id;
  RobotEntry entry;
  // Fidelity full: the body of link k is first_body + k, with the axes of its inertial frame. Rolling and
  // planar: one body for all links, at their common centre of mass, with the axes of R.
  int first_body = 0;
  int body_count = 0;
  int slot = -1;          // index of its drive's set-points in Frame::robots; its own index
  Pose X_BR;              // R in its first body
  bool axes_of_R = true;  // X_BR does not turn

  bool one_body() const { return entry.fidelity != Fidelity::kFull; }
};

struct Scene {
  std::shared_ptr<const Scenario> scenario;
  Floor floor;
  std::vector<SceneObject> objects;
  std::vector<SceneRobot> robots;  // by increasing id
  std::vector<Target> targets;     // by increasing id
  std::vector<BodyId> body_ids;    // of Frame::bodies, increasing
  SceneCacheSlot cache;            // of sensing

  /// Index of the robot called `name`; -1 if there is none.
  int FindRobot(std::string_view name) const;
};

/// Centre of mass of all links of `model` in R, in the initial pose.
Vector3 CenterOfMass(const RobotModel& model);

/// The scene of `scenario` at its start. Bodies: dynamic objects in file order, then the robots'.
std::shared_ptr<const Scene> MakeScene(std::shared_ptr<const Scenario> scenario);

}  // namespace coopdyn
