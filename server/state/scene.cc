// SPDX-License-Identifier: MIT
#include "server/state/scene.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

/// R in the robot's first body.
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

int Scene::FindRobot(std::string_view name) const {
  const auto found =
      std::find_if(robots.begin(), robots.end(), [&](const SceneRobot& r) { return r.entry.name == name; });
  return found == robots.end() ? -1 : static_cast<int>(found - robots.begin());
}

std::shared_ptr<const Scene> MakeScene(std::shared_ptr<const Scenario> scenario) {
  auto scene = std::make_shared<Scene>();
  scene->floor = scenario->floor;
  scene->targets = scenario->targets;
  int bodies = 0;
  for (const WorldObject& object : scenario->objects) {
    const ObjectId id{static_cast<std::uint32_t>(scene->objects.size() + 1)};
    scene->objects.push_back({id, object, object.is_static() ? -1 : bodies++});
  }
  for (std::size_t i = 0; i < scenario->targets.size(); ++i) {
    scene->targets[i].id = TargetId{static_cast<std::uint32_t>(i + 1)};
  }
  for (const RobotEntry& entry : scenario->robots) {
    const int index = static_cast<int>(scene->robots.size());
    const int links = static_cast<int>(entry.model->links.size());
    SceneRobot robot{RobotId{static_cast<std::uint32_t>(index + 1)}, entry, bodies,
                     entry.fidelity == Fidelity::kFull ? links : 1,  index, PlaceOfR(entry)};
    robot.axes_of_R = robot.X_BR.q.vec().isZero(0);
    robot.entry.id = robot.id;
    bodies += robot.body_count;
    scene->robots.push_back(std::move(robot));
  }
  for (int body = 0; body < bodies; ++body) {
    scene->body_ids.push_back(BodyId{static_cast<std::uint32_t>(body + 1)});
  }
  scene->scenario = std::move(scenario);
  return scene;
}

}  // namespace coopdyn
