// SPDX-License-Identifier: MIT
// What stands in the world now: the scenario's things with their places in a frame. Immutable once published;
// a world edit makes a new one. Any thread.
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
  // Fidelity full: the body of link k is first_body + k, with the axes of its inertial frame. Rolling and
  // planar: one body for all links, at their common centre of mass, with the axes of R.
  int first_body = 0;
  int body_count = 0;
  int first_channel = 0;  // of Scene::channels
  int channel_count = 0;
  int first_actuator = 0;  // of Scene::actuators
  int actuator_count = 0;  // at least 1
  int first_control = 0;   // of Frame::controls
  int control_count = 0;
  int first_drive_train = 0;  // of Frame::drive_trains
  int drive_train_count = 0;
  int first_measured = 0;   // of Frame::measured
  std::vector<int> clocks;  // by sensor: index into Scene::clocks, -1: each step; empty: all each step
  Pose X_BR;                // R in its first body
  bool axes_of_R = true;    // X_BR does not turn

  bool one_body() const { return entry.fidelity != Fidelity::kFull; }
};

/// A joint axis that is driven: its place in Frame::channels.
struct Channel {
  int robot = 0;         // index into Scene::robots
  int joint = 0;         // index into the model's joints
  int control = -1;      // of Frame::controls, if it belongs to a control board
  int drive_train = -1;  // of Frame::drive_trains, if its joint has one
};

/// An actuator module: what one command drives. A robot without any has one without channels, by which it
/// broadcasts.
struct SceneActuator {
  int robot = 0;       // index into Scene::robots
  std::string module;  // empty: nobody can command it
  int first_channel = 0;
  int channel_count = 0;
};

/// Values derived from a scene. Freed with the scene.
struct SceneCache {
  virtual ~SceneCache() = default;
};

/// A place on a scene for what others derive from it at first use, e.g. sensing. Any thread.
class SceneCacheSlot {
 public:
  SceneCacheSlot() = default;
  ~SceneCacheSlot() = default;
  /// A copy of a scene derives its own.
  SceneCacheSlot(const SceneCacheSlot& /*other*/) {}
  SceneCacheSlot& operator=(const SceneCacheSlot&) = delete;

  /// What the first caller's make(), a unique_ptr to a SceneCache, returned. Lives as long as the scene.
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
  double ambient_light = 0;              // what a light sensor reads without lamps
  std::vector<BodyId> body_ids;          // of Frame::bodies, increasing
  std::vector<Channel> channels;         // of Frame::channels: robot by robot, actuator by actuator
  std::vector<SceneActuator> actuators;  // robot by robot
  int control_count = 0;                 // joints of control boards: Frame::controls
  int drive_train_count = 0;             // of those, the ones with a drive train: Frame::drive_trains
  int measured_count = 0;                // values that physics measures for sensors: Frame::measured
  bool measures_contacts = false;        // a robot has a sensor that needs them: Frame::contacts
  std::vector<SensorTiming> clocks;      // of sensors that do not show each step: Frame::samples
  SceneCacheSlot cache;                  // of sensing

  /// Index of the robot called `name`; -1 if there is none.
  int FindRobot(std::string_view name) const;
  /// Index of the actuator whose module is `module` of robot `robot`; -1 if there is none.
  int FindActuator(int robot, std::string_view module) const;
  /// Index of the first channel of the robot's two-wheel drive; -1 if it has none.
  int FindDrive(int robot) const;
};

/// The controllers that are to be loaded: the supervisor, then those of robots.
std::vector<const ControllerChoice*> ControllersOf(const Scene& scene);

/// Centre of mass of all links of `model` in R, in the initial pose.
Vector3 CenterOfMass(const RobotModel& model);

/// Appends `robot` with its actuators and channels.
void AddRobot(Scene& scene, SceneRobot robot);

/// Lays out things, robots and targets, each by increasing id, in a scene that has none yet: bodies are those
/// of the dynamic objects, then the robots', numbered from 1. @pre ids, and each robot's entry
void FillScene(Scene& scene, std::vector<SceneObject> objects, std::vector<SceneRobot> robots,
               std::vector<Target> targets);

/// The scene of `scenario` at its start. Bodies: dynamic objects in file order, then the robots'.
std::shared_ptr<const Scene> MakeScene(std::shared_ptr<const Scenario> scenario);

}  // namespace coopdyn
