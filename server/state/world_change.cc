// SPDX-License-Identifier: MIT
#include "server/state/world_change.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <unordered_set>
#include <utility>

#include "server/model/values.h"

namespace coopdyn {

namespace {

template <typename Things, typename Key>
auto FindById(Things& things, Key id) {
  const auto found = std::ranges::lower_bound(things, id, {}, [](const auto& thing) { return thing.id; });
  return found != things.end() && found->id == id ? found : things.end();
}

template <typename Things, typename Key>
bool Remove(Things& things, const std::vector<Key>& gone, std::string& refusal) {
  for (const Key id : gone) {
    const auto found = FindById(things, id);
    if (found == things.end()) {
      refusal = "it is not there any more";
      return false;
    }
    things.erase(found);
  }
  return true;
}

/// Inserts `thing` by id, or replaces the one with its id.
template <typename Things, typename Thing>
void Put(Things& things, Thing thing) {
  const auto found =
      std::ranges::lower_bound(things, thing.id, {}, [](const auto& other) { return other.id; });
  if (found != things.end() && found->id == thing.id) {
    *found = std::move(thing);
  } else {
    things.insert(found, std::move(thing));
  }
}

/// Things and lamps share section names; robots share theirs with swarms.
std::string TakenName(const Scene& scene) {
  std::unordered_set<std::string> sections, robots;
  for (const SceneObject& thing : scene.objects) {
    if (!sections.insert(ToLower(thing.object.name)).second) return thing.object.name;
  }
  for (const PointLight& light : scene.lights) {
    if (!sections.insert(ToLower(light.name)).second) return light.name;
  }
  for (const SwarmEntry& swarm : scene.scenario->swarms) {
    robots.insert(ToLower(swarm.name));
    robots.insert(swarm.section);
  }
  for (const SceneRobot& robot : scene.robots) {
    if (!robots.insert(ToLower(robot.entry.name)).second) return robot.entry.name;
  }
  return {};
}

void CopyRobot(const Frame& from, const SceneRobot& of, Frame& to, const SceneRobot& robot) {
  const auto copy = [](const auto& source, int first, auto& target, int place, int count) {
    if (std::ssize(source) < first + count) return;
    std::copy_n(source.begin() + first, count, target.begin() + place);
  };
  if (of.body_count == robot.body_count)
    copy(from.bodies, of.first_body, to.bodies, robot.first_body, robot.body_count);
  if (of.channel_count == robot.channel_count)
    copy(from.channels, of.first_channel, to.channels, robot.first_channel, robot.channel_count);
  if (of.control_count == robot.control_count)
    copy(from.controls, of.first_control, to.controls, robot.first_control, robot.control_count);
  if (of.drive_train_count == robot.drive_train_count)
    copy(from.drive_trains, of.first_drive_train, to.drive_trains, robot.first_drive_train,
         robot.drive_train_count);
  const int measured = static_cast<int>(robot.entry.model->FirstMeasured(robot.entry.model->sensors.size()));
  if (of.entry.model == robot.entry.model)
    copy(from.measured, of.first_measured, to.measured, robot.first_measured, measured);
}

/// Copies contacts and broadcasts, with indices into the new scene.
void CopyEvents(const Frame& from, const std::vector<int>& robots, Frame& to) {
  const Scene& before = *from.scene;
  std::vector<int> now(before.robots.size(), -1);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i] >= 0) now[static_cast<std::size_t>(robots[i])] = static_cast<int>(i);
  }
  const auto moved = [&](ContactEnd& end) {
    if (end.robot >= 0) {
      end.robot = now[static_cast<std::size_t>(end.robot)];
      return end.robot >= 0;
    }
    if (end.object < 0) return true;
    const auto found = FindById(to.scene->objects, before.objects[static_cast<std::size_t>(end.object)].id);
    end.object = static_cast<std::int32_t>(found - to.scene->objects.begin());
    return found != to.scene->objects.end();
  };
  for (Contact contact : from.contacts) {
    if (moved(contact.a) && moved(contact.b)) to.contacts.push_back(contact);
  }
  for (SentMessage message : from.messages) {
    const int place = now[message.robot];
    if (place < 0) continue;
    message.robot = static_cast<std::uint32_t>(place);
    to.messages.push_back(message);
  }
}

PutObject PutBack(const SceneObject& thing, const Frame& frame) {
  PutObject put{thing.id, thing.object, Placing::kExact};
  if (thing.body >= 0) put.body = frame.bodies[static_cast<std::size_t>(thing.body)];
  return put;
}

PutRobot PutBack(const SceneRobot& robot, const Frame& frame) {
  PutRobot put{robot.id, robot.entry, Placing::kExact};
  const auto copy = [](const auto& from, int first, int count, auto& to) {
    to.assign(from.begin() + first, from.begin() + first + count);
  };
  copy(frame.bodies, robot.first_body, robot.body_count, put.bodies);
  copy(frame.channels, robot.first_channel, robot.channel_count, put.channels);
  for (ChannelState& channel : put.channels) channel.effort = ChannelState().effort;  // not recorded
  copy(frame.controls, robot.first_control, robot.control_count, put.controls);
  copy(frame.drive_trains, robot.first_drive_train, robot.drive_train_count, put.drive_trains);
  const RobotModel& model = *robot.entry.model;
  const int measured = static_cast<int>(model.FirstMeasured(model.sensors.size()));
  if (std::ssize(frame.measured) >= robot.first_measured + measured)
    copy(frame.measured, robot.first_measured, measured, put.measured);
  return put;
}

}  // namespace

std::string TargetName(const Target& target) {
  return target.color_name + "_target_" + std::to_string(target.id.value);
}

void AssignIds(const Scene& scene, UsedIds& used, WorldChange& change) {
  const auto newest = [](const auto& things, std::uint32_t& last) {
    if (!things.empty()) last = std::max(last, things.back().id.value);
  };
  newest(scene.objects, used.object);
  newest(scene.robots, used.robot);
  newest(scene.targets, used.target);
  const auto assign = [](auto& things, std::uint32_t& last) {
    for (auto& thing : things) {
      if (!thing.id) thing.id.value = ++last;
      last = std::max(last, thing.id.value);
    }
  };
  assign(change.objects, used.object);
  assign(change.robots, used.robot);
  assign(change.targets, used.target);
  for (PutRobot& robot : change.robots) robot.entry.id = robot.id;
}

std::shared_ptr<const Scene> ChangedScene(const Scene& before, const WorldChange& change,
                                          std::string& refusal) {
  std::vector<SceneObject> objects = before.objects;
  std::vector<SceneRobot> robots = before.robots;
  std::vector<Target> targets = before.targets;
  if (!Remove(objects, change.gone_objects, refusal) || !Remove(robots, change.gone_robots, refusal) ||
      !Remove(targets, change.gone_targets, refusal)) {
    return nullptr;
  }
  for (const PutObject& put : change.objects) Put(objects, SceneObject{put.id, put.object, -1});
  for (const PutRobot& put : change.robots) {
    SceneRobot robot;
    robot.id = put.id;
    robot.entry = put.entry;
    Put(robots, std::move(robot));
  }
  for (const Target& target : change.targets) Put(targets, target);
  constexpr auto kMost = static_cast<std::uint32_t>(WorldId::kMost);
  if ((!objects.empty() && objects.back().id.value > kMost) ||
      (!robots.empty() && robots.back().id.value > kMost) ||
      (!targets.empty() && targets.back().id.value > kMost)) {
    refusal = "no more ids are left: save the world and load it again";
    return nullptr;
  }
  auto scene = std::make_shared<Scene>();
  scene->scenario = before.scenario;
  scene->floor = before.floor;
  scene->lights = change.lights.value_or(before.lights);
  scene->ambient_light = before.ambient_light;
  FillScene(*scene, std::move(objects), std::move(robots), std::move(targets));
  if (const std::string taken = TakenName(*scene); !taken.empty()) {
    refusal = "the name " + taken + " is taken: give it another name";
    return nullptr;
  }
  return scene;
}

std::vector<int> PlacesIn(const Scene& before, const Scene& scene) {
  std::vector<int> places(scene.robots.size(), -1);
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const auto found = FindById(before.robots, scene.robots[i].id);
    if (found != before.robots.end()) places[i] = static_cast<int>(found - before.robots.begin());
  }
  return places;
}

std::shared_ptr<Frame> InScene(const Frame& from, const std::shared_ptr<const Scene>& scene,
                               const Frame* other) {
  auto frame = std::make_shared<Frame>();
  frame->epoch = from.epoch;
  frame->step = from.step;
  frame->revision = from.revision;
  frame->time = from.time;
  frame->step_length = from.step_length;
  frame->seed = from.seed;
  frame->solver_seed = from.solver_seed;
  frame->scene = scene;
  if (other != nullptr) {
    frame->bodies = other->bodies;
    frame->channels = other->channels;
    frame->controls = other->controls;
    frame->drive_trains = other->drive_trains;
    frame->measured = other->measured;
  } else {
    frame->controls = StartControls(*scene);
    frame->drive_trains = StartDriveTrains(*scene);
    frame->channels.resize(scene->channels.size());
    for (std::size_t i = 0; i < scene->channels.size(); ++i) frame->channels[i].position = StartOf(*scene, i);
  }
  frame->bodies.resize(scene->body_ids.size());
  frame->measured.resize(static_cast<std::size_t>(scene->measured_count));
  frame->commanded.resize(scene->actuators.size());
  const Scene& before = *from.scene;
  for (const SceneObject& thing : scene->objects) {
    const auto found = FindById(before.objects, thing.id);
    if (found == before.objects.end() || found->body < 0 || thing.body < 0) continue;
    frame->bodies[static_cast<std::size_t>(thing.body)] = from.bodies[static_cast<std::size_t>(found->body)];
  }
  const std::vector<int> robots = PlacesIn(before, *scene);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i] < 0) continue;
    const SceneRobot& of = before.robots[static_cast<std::size_t>(robots[i])];
    CopyRobot(from, of, *frame, scene->robots[i]);
    for (int k = 0; k < of.actuator_count && k < scene->robots[i].actuator_count; ++k) {
      const auto source = static_cast<std::size_t>(of.first_actuator) + static_cast<std::size_t>(k);
      if (source < from.commanded.size())
        frame->commanded[static_cast<std::size_t>(scene->robots[i].first_actuator) +
                         static_cast<std::size_t>(k)] = from.commanded[source];
    }
  }
  CopyEvents(from, robots, *frame);
  return frame;
}

WorldChange InverseOf(const WorldChange& change, const Frame& before) {
  const Scene& scene = *before.scene;
  WorldChange inverse;
  inverse.label = change.label;
  for (const ObjectId id : change.gone_objects)
    inverse.objects.push_back(PutBack(*FindById(scene.objects, id), before));
  for (const RobotId id : change.gone_robots)
    inverse.robots.push_back(PutBack(*FindById(scene.robots, id), before));
  for (const TargetId id : change.gone_targets) inverse.targets.push_back(*FindById(scene.targets, id));
  for (const PutObject& put : change.objects) {
    const auto was = FindById(scene.objects, put.id);
    if (was == scene.objects.end()) {
      inverse.gone_objects.push_back(put.id);
    } else {
      inverse.objects.push_back(PutBack(*was, before));
      const bool keeps = put.placing == Placing::kKeep && was->object.is_static() == put.object.is_static();
      if (keeps) inverse.objects.back().placing = Placing::kKeep;
    }
  }
  for (const PutRobot& put : change.robots) {
    const auto was = FindById(scene.robots, put.id);
    if (was == scene.robots.end()) {
      inverse.gone_robots.push_back(put.id);
    } else {
      inverse.robots.push_back(PutBack(*was, before));
      if (put.placing == Placing::kKeep) inverse.robots.back().placing = Placing::kKeep;
    }
  }
  for (const Target& target : change.targets) {
    const auto was = FindById(scene.targets, target.id);
    if (was == scene.targets.end()) {
      inverse.gone_targets.push_back(target.id);
    } else {
      inverse.targets.push_back(*was);
    }
  }
  if (change.lights) inverse.lights = scene.lights;
  return inverse;
}

}  // namespace coopdyn
