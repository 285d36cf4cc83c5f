// SPDX-License-Identifier: MIT
// The current world: WorldText(), a scenario that loads to the same world, and WorldJson(), the answer to
// `list` of /world (docs/protocol.md). All objects of a list have the same keys.
#include <boost/json.hpp>
#include <utility>

#include "protocol/json_text.h"
#include "server/base/printable.h"
#include "server/control/world_parts.h"
#include "server/model/readers.h"
#include "server/model/scenario_writer.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

json::array Numbers(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
json::array Numbers(const Quaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}
json::array Numbers(const Color& color) {
  return {color.r, color.g, color.b};
}

json::object ThingJson(const Frame& frame, const SceneObject& thing) {
  const WorldObject& object = thing.object;
  json::string type = "box";
  json::array size;
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    size = Numbers(box->size_m);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
    type = "cylinder";
    size = {2 * cylinder->radius_m, 2 * cylinder->radius_m, cylinder->length_m};
  } else if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    type = "sphere";
    size = {2 * sphere->radius_m};
  }
  const Pose X = ObjectPose(frame, thing);
  const WorldObject now = ObjectNow(frame, thing);
  return {{"id", thing.id.value},          {"name", object.name},
          {"type", std::move(type)},       {"size", std::move(size)},
          {"position", Numbers(X.p)},      {"quaternion", Numbers(X.q)},
          {"mass", object.mass_kg},        {"color", Numbers(object.color)},
          {"friction", object.friction},   {"texture", object.texture.name},
          {"bounce", object.restitution},  {"rolling_friction", object.rolling_friction_m},
          {"velocity", Numbers(now.v_WO)}, {"turn_rate", Numbers(now.w_WO)}};
}

json::object RobotJson(const Frame& frame, int place) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(place)];
  const Pose X = RobotPose(frame, place);
  return {{"id", WorldIdOf(robot)},
          {"name", robot.entry.name},
          {"type", robot.entry.model->type},
          {"position", Numbers(X.p)},
          {"quaternion", Numbers(X.q)},
          {"color", Numbers(robot.entry.color)},
          {"fidelity", ToString(robot.entry.fidelity)},
          {"controller", robot.entry.controller.name}};
}

}  // namespace

std::string WorldText(const Frame& frame, const RunStatus& status) {
  const Scene& scene = *frame.scene;
  SimulationOptions simulation = scene.scenario->simulation;
  simulation.mode = status.mode;
  simulation.step = status.step_length;
  simulation.seed = frame.seed;
  std::string text = "# The world of " + Printable(scene.scenario->name) + " at " +
                     ExactNumber(frame.time_s()) + " s\n" + WriteSimulation(simulation, scene.ambient_light) +
                     "\n" + WriteFloor(scene.floor);
  for (const std::string& section : {WriteTask(scene.scenario->task), WriteView(scene.scenario->view)}) {
    if (!section.empty()) text += "\n" + section;
  }
  for (const SceneObject& thing : scene.objects) text += "\n" + WriteObject(ObjectNow(frame, thing));
  for (const PointLight& light : scene.lights) text += "\n" + WriteLight(light);
  if (!scene.targets.empty()) text += "\n" + WriteTargets(scene.targets);
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const RobotEntry robot = RobotNow(frame, static_cast<int>(i));
    text += "\n" + WriteRobot(robot, i + 1, TypeFromAnywhere(*robot.model));
  }
  return text;
}

std::string WorldJson(const Frame& frame, const RunStatus& status) {
  const Scene& scene = *frame.scene;
  json::array things, robots, targets, lights;
  for (const SceneObject& thing : scene.objects) things.push_back(ThingJson(frame, thing));
  for (std::size_t i = 0; i < scene.robots.size(); ++i)
    robots.push_back(RobotJson(frame, static_cast<int>(i)));
  for (const Target& target : scene.targets) {
    targets.push_back({{"id", WorldIdOf(target)},
                       {"name", TargetName(target)},
                       {"color_name", target.color_name},
                       {"color", Numbers(target.color)},
                       {"position", Numbers(target.p_WT)}});
  }
  std::int32_t number = WorldId::kLights;
  for (const PointLight& light : scene.lights) {
    lights.push_back({{"id", ++number},
                      {"name", light.name},
                      {"position", Numbers(light.p_WP)},
                      {"color", Numbers(light.color)},
                      {"power", light.power},
                      {"shadows", light.casts_shadows}});
  }
  const Floor& floor = scene.floor;
  const json::object world{
      {"scenario", scene.scenario->name},
      {"undo", status.undo},
      {"redo", status.redo},
      {"floor", {{"size", {floor.length_m, floor.width_m, floor.height_m}}, {"color", Numbers(floor.color)}}},
      {"things", std::move(things)},
      {"robots", std::move(robots)},
      {"targets", std::move(targets)},
      {"lights", std::move(lights)}};
  return JsonText(world);
}

}  // namespace coopdyn
