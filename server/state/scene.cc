// SPDX-License-Identifier: MIT
#include "server/state/scene.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

/// Pose of R in the robot's first body.
Pose PlaceOfR(const RobotEntry& entry) {
  if (entry.fidelity != Fidelity::kFull) return {-CenterOfMass(*entry.model), Quaternion::Identity()};
  const LinkModel& chassis = entry.model->links.front();
  return (chassis.X_RL * chassis.X_LI).Inverse();
}

}  // namespace

Vector3 CenterOfMass(const RobotModel& model) {
  double mass_kg = 0;
  Vector3 moment = Vector3::Zero();
  for (const LinkModel& link : model.links) {
    mass_kg += link.mass_kg;
    moment += link.mass_kg * (link.X_RL * link.X_LI.p);
  }
  if (mass_kg <= 0) return Vector3::Zero();
  return moment / mass_kg;
}

std::vector<const ControllerChoice*> ControllersOf(const Scene& scene) {
  std::vector<const ControllerChoice*> controllers;
  const auto add = [&controllers](const ControllerChoice& choice) {
    if (!choice.empty()) controllers.push_back(&choice);
  };
  add(scene.scenario->simulation.supervisor);
  for (const SceneRobot& robot : scene.robots) add(robot.entry.controller);
  return controllers;
}

int Scene::FindRobot(std::string_view name) const {
  const auto found =
      std::find_if(robots.begin(), robots.end(), [&](const SceneRobot& r) { return r.entry.name == name; });
  return found == robots.end() ? -1 : static_cast<int>(found - robots.begin());
}

int Scene::FindActuator(int robot, std::string_view module) const {
  const SceneRobot& of = robots[static_cast<std::size_t>(robot)];
  for (int i = of.first_actuator; i < of.first_actuator + of.actuator_count; ++i) {
    const SceneActuator& actuator = actuators[static_cast<std::size_t>(i)];
    if (!actuator.module.empty() && actuator.module == module) return i;
  }
  return -1;
}

int Scene::FindDrive(int robot) const {
  const SceneRobot& of = robots[static_cast<std::size_t>(robot)];
  const RobotModel& model = *of.entry.model;
  const ActuatorModel* drive = model.drive_actuator();
  return drive == nullptr ? -1 : of.first_channel + static_cast<int>(model.FirstChannel(*drive));
}

namespace {

/// Reserves measured values and clocks for the robot's sensors.
void AddSensors(Scene& scene, SceneRobot& robot) {
  const RobotModel& model = *robot.entry.model;
  robot.first_measured = scene.measured_count;
  scene.measured_count += static_cast<int>(model.FirstMeasured(model.sensors.size()));
  robot.clocks.clear();
  for (std::size_t i = 0; i < model.sensors.size(); ++i) {
    const SensorModel& sensor = model.sensors[i];
    scene.measures_contacts |=
        std::holds_alternative<ContactModel>(sensor.kind) || std::holds_alternative<WrenchModel>(sensor.kind);
    if (sensor.timing.each_step()) continue;
    const auto found = std::ranges::find(scene.clocks, sensor.timing);
    robot.clocks.resize(model.sensors.size(), -1);
    robot.clocks[i] = static_cast<int>(found - scene.clocks.begin());
    if (found == scene.clocks.end()) scene.clocks.push_back(sensor.timing);
  }
}

}  // namespace

void AddRobot(Scene& scene, SceneRobot robot) {
  const int index = static_cast<int>(scene.robots.size());
  robot.first_channel = static_cast<int>(scene.channels.size());
  robot.first_actuator = static_cast<int>(scene.actuators.size());
  robot.first_control = scene.control_count;
  robot.first_drive_train = scene.drive_train_count;
  for (const ActuatorModel& actuator : robot.entry.model->actuators) {
    scene.actuators.push_back({index, actuator.module, static_cast<int>(scene.channels.size()),
                               static_cast<int>(actuator.joints.size())});
    for (const int joint : actuator.joints) {
      const bool has_train =
          actuator.is_board() &&
          robot.entry.model->joints[static_cast<std::size_t>(joint)].drive_train.has_value();
      scene.channels.push_back({index, joint, actuator.is_board() ? scene.control_count++ : -1,
                                has_train ? scene.drive_train_count++ : -1});
    }
  }
  if (robot.entry.model->actuators.empty()) scene.actuators.push_back({index, "", robot.first_channel, 0});
  robot.channel_count = static_cast<int>(scene.channels.size()) - robot.first_channel;
  robot.control_count = scene.control_count - robot.first_control;
  robot.drive_train_count = scene.drive_train_count - robot.first_drive_train;
  robot.actuator_count = static_cast<int>(scene.actuators.size()) - robot.first_actuator;
  AddSensors(scene, robot);
  scene.robots.push_back(std::move(robot));
}

void FillScene(Scene& scene, std::vector<SceneObject> objects, std::vector<SceneRobot> robots,
               std::vector<Target> targets) {
  int bodies = 0;
  scene.objects = std::move(objects);
  scene.targets = std::move(targets);
  for (SceneObject& thing : scene.objects) thing.body = thing.object.is_static() ? -1 : bodies++;
  scene.robots.reserve(robots.size());
  for (SceneRobot& robot : robots) {
    const int links = static_cast<int>(robot.entry.model->links.size());
    robot.entry.id = robot.id;
    robot.first_body = bodies;
    robot.body_count = robot.entry.fidelity == Fidelity::kFull ? links : 1;
    robot.X_BR = PlaceOfR(robot.entry);
    robot.axes_of_R = robot.X_BR.q.vec().isZero(0);
    bodies += robot.body_count;
    AddRobot(scene, std::move(robot));
  }
  scene.measures_contacts |= CountsCollisions(*scene.scenario);
  for (int body = 0; body < bodies; ++body) {
    scene.body_ids.push_back(BodyId{static_cast<std::uint32_t>(body + 1)});
  }
}

std::shared_ptr<const Scene> MakeScene(std::shared_ptr<const Scenario> scenario) {
  auto scene = std::make_shared<Scene>();
  scene->scenario = scenario;
  scene->floor = scenario->floor;
  scene->lights = scenario->lights;
  scene->ambient_light = scenario->ambient_light;
  std::vector<SceneObject> objects;
  for (const WorldObject& object : scenario->objects) {
    objects.push_back({ObjectId{static_cast<std::uint32_t>(objects.size() + 1)}, object});
  }
  std::vector<Target> targets = scenario->targets;
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i].id = TargetId{static_cast<std::uint32_t>(i + 1)};
  std::vector<SceneRobot> robots;
  for (const RobotEntry& entry : scenario->robots) {
    SceneRobot robot;
    robot.id = RobotId{static_cast<std::uint32_t>(robots.size() + 1)};
    robot.entry = entry;
    robots.push_back(std::move(robot));
  }
  FillScene(*scene, std::move(objects), std::move(robots), std::move(targets));
  return scene;
}

}  // namespace coopdyn
