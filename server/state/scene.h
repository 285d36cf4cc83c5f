// SPDX-License-Identifier: MIT
// The things in the world now, with their places in a frame. Immutable once published; a world edit makes a
// new scene. Any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/mutex.h"
#include "server/model/scenario.h"

namespace coopdyn {

struct SceneObject {
  ObjectId id;
  WorldObject object;
  int body = -1;  // index into Frame::bodies; -1: static
};

struct SceneRobot {
  RobotId id;
  RobotEntry entry;
  // Fidelity full: link k's body is first_body + k, with the axes of its inertial frame. Rolling and planar:
  // one body for all links, at their common centre of mass, with the axes of R.
  int first_body = 0;
  int body_count = 0;
  int first_channel = 0;  // index into Scene::channels
  int channel_count = 0;
  int first_actuator = 0;  // index into Scene::actuators
  int actuator_count = 0;  // at least 1
  int first_control = 0;   // index into Frame::controls
  int control_count = 0;
  int first_drive_train = 0;  // index into Frame::drive_trains
  int drive_train_count = 0;
  int first_measured = 0;   // index into Frame::measured
  std::vector<int> clocks;  // by sensor: index into Scene::clocks, -1: every step; empty: all every step
  Pose X_BR;                // pose of R in the first body
  bool axes_of_R = true;    // X_BR has no rotation

  bool one_body() const { return entry.fidelity != Fidelity::kFull; }
};

/// A driven joint axis; its index is its place in Frame::channels.
struct Channel {
  int robot = 0;         // index into Scene::robots
  int joint = 0;         // index into the model's joints
  int control = -1;      // index into Frame::controls; -1 if not of a control board
  int drive_train = -1;  // index into Frame::drive_trains; -1 if the joint has none
};

/// An actuator module: the joints that one command drives. A robot without actuators has one without
/// channels, for its broadcasts.
struct SceneActuator {
  int robot = 0;       // index into Scene::robots
  std::string module;  // empty: accepts no commands
  int first_channel = 0;
  int channel_count = 0;
};

/// Values derived from a scene. Freed with the scene.
struct SceneCache {
  virtual ~SceneCache() = default;
};

/// Room on a scene for values that others, e.g. sensing, derive from it on first use. Thread-safe.
class SceneCacheSlot {
 public:
  SceneCacheSlot() = default;
  ~SceneCacheSlot() = default;
  /// A scene's copy derives its own values.
  SceneCacheSlot(const SceneCacheSlot& /*other*/) {}
  SceneCacheSlot& operator=(const SceneCacheSlot&) = delete;

  /// Returns the result of the first caller's make(), a unique_ptr to a SceneCache. Lives as long as the
  /// scene.
  template <typename Make>
  const SceneCache& Get(Make make) const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (cache_ == nullptr) cache_ = make();
    return *cache_;
  }

 private:
  mutable Mutex mutex_;
  mutable std::unique_ptr<const SceneCache> cache_ GUARDED_BY(mutex_);
};

struct Scene {
  std::shared_ptr<const Scenario> scenario;
  Floor floor;
  std::vector<SceneObject> objects;
  std::vector<SceneRobot> robots;  // by increasing id
  std::vector<Target> targets;     // by increasing id
  std::vector<PointLight> lights;
  double ambient_light = 0;              // reading of a light sensor without lamps
  std::vector<BodyId> body_ids;          // of Frame::bodies, increasing
  std::vector<Channel> channels;         // of Frame::channels: robot by robot, actuator by actuator
  std::vector<SceneActuator> actuators;  // robot by robot
  int control_count = 0;                 // number of control-board joints: Frame::controls
  int drive_train_count = 0;             // number of these with a drive train: Frame::drive_trains
  int measured_count = 0;                // number of values that physics measures for sensors:
                                         // Frame::measured
  bool measures_contacts = false;        // some sensor needs contacts: Frame::contacts
  std::vector<SensorTiming> clocks;      // of sensors that do not show every step: Frame::samples
  SceneCacheSlot cache;                  // of sensing

  /// Index of the robot called `name`; -1 if there is none.
  int FindRobot(std::string_view name) const;
  /// Index of the actuator whose module is `module` of robot `robot`; -1 if there is none.
  int FindActuator(int robot, std::string_view module) const;
  /// Index of the first channel of the robot's two-wheel drive; -1 if it has none.
  int FindDrive(int robot) const;
};

/// The controllers to load: the supervisor's, then those of robots.
std::vector<const ControllerChoice*> ControllersOf(const Scene& scene);

/// Centre of mass of all links of `model`, in R, in the initial pose.
Vector3 CenterOfMass(const RobotModel& model);

/// Appends `robot` with its actuators and channels.
void AddRobot(Scene& scene, SceneRobot robot);

/// Lays out things, robots and targets, each by increasing id, in an empty scene. Bodies are numbered from 1:
/// dynamic objects, then robots. @pre all ids and each robot's entry are set
void FillScene(Scene& scene, std::vector<SceneObject> objects, std::vector<SceneRobot> robots,
               std::vector<Target> targets);

/// The scene of `scenario` at its start. Bodies: dynamic objects in file order, then robots.
std::shared_ptr<const Scene> MakeScene(std::shared_ptr<const Scenario> scenario);

}  // namespace coopdyn
