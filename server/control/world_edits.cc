// SPDX-License-Identifier: MIT
#include "server/control/world_edits.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_set>
#include <utility>

#include "server/control/world_parts.h"
#include "server/model/section_reader.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Everything in the world now, as a scenario.
Scenario Surroundings(const Frame& frame) {
  const Scene& scene = *frame.scene;
  Scenario around;
  around.floor = scene.floor;
  around.simulation = scene.scenario->simulation;
  around.simulation.seed = frame.seed;
  around.lights = scene.lights;
  for (const SceneObject& thing : scene.objects) around.objects.push_back(ObjectNow(frame, thing));
  for (std::size_t i = 0; i < scene.robots.size(); ++i)
    around.robots.push_back(RobotNow(frame, static_cast<int>(i)));
  return around;
}

/// Replaces each [NAME_*] by the next free number.
std::string WithNumbers(std::string text, const Scene& scene) {
  std::unordered_set<std::string> taken;
  for (const SceneObject& thing : scene.objects) taken.insert(ToLower(thing.object.name));
  for (const PointLight& light : scene.lights) taken.insert(ToLower(light.name));
  for (const SceneRobot& robot : scene.robots) taken.insert(ToLower(robot.entry.name));
  for (const SwarmEntry& swarm : scene.scenario->swarms) {
    taken.insert(ToLower(swarm.name));
    taken.insert(swarm.section);
  }
  constexpr std::string_view kAny = "_*]";
  for (std::size_t star = 0; (star = text.find(kAny, star)) != std::string::npos;) {
    const std::size_t open = text.rfind('[', star);
    if (open == std::string::npos) break;
    const std::string stem = ToLower(text.substr(open + 1, star - open - 1));
    for (int number = 1;; ++number) {
      const std::string digits = std::to_string(number);
      if (taken.contains(stem + "_" + digits) || taken.contains(stem + digits)) continue;
      taken.insert(stem + "_" + digits);
      text.replace(star + 1, 1, digits);
      break;
    }
  }
  return text;
}

}  // namespace

ResolvedEdit ResolveInsert(const Frame& frame, const std::string& text, RobotLibrary& robots) {
  Diagnostics diagnostics;
  const auto read =
      ReadInsertion(WithNumbers(WithLines(text), *frame.scene), robots, Surroundings(frame), diagnostics);
  if (read == nullptr) return Refuse(Error::kMalformed, Lined(diagnostics));
  ResolvedEdit edit;
  WorldChange& change = edit.change;
  for (const WorldObject& object : read->objects) change.objects.push_back({{}, object, Placing::kStart});
  for (const RobotEntry& robot : read->robots) change.robots.push_back({{}, robot, Placing::kStart});
  for (Target target : read->targets) {
    target.id = {};
    change.targets.push_back(std::move(target));
  }
  if (!read->lights.empty()) {
    change.lights = frame.scene->lights;
    change.lights->insert(change.lights->end(), read->lights.begin(), read->lights.end());
  }
  if (change.empty()) {
    return Refuse(
        Error::kMalformed,
        "there is nothing to insert: write a section, for example: insert [BOX_*] | type box | size 1 "
        "1 0.5 | position 2 1");
  }
  std::string names;
  for (const PutObject& put : change.objects) AddTo(names, put.object.name);
  for (const PutRobot& put : change.robots) AddTo(names, put.entry.name);
  for (const Target& target : change.targets) AddTo(names, target.color_name + " target");
  for (const PointLight& light : read->lights) AddTo(names, light.name);
  change.label = "insert " + names;
  edit.text = Lined(diagnostics);
  return edit;
}

ResolvedEdit ResolveRemove(const Frame& frame, const std::string& text, std::span<const std::int32_t> ids) {
  const Scene& scene = *frame.scene;
  ResolvedEdit edit;
  std::vector<Found> all;
  for (const std::string& word : SplitWords(text)) {
    all.push_back(FindName(scene, word));
    if (!all.back().any()) return NoSuchThing(scene, word);
  }
  for (const std::int32_t id : ids) {
    all.push_back(FindId(scene, id));
    if (!all.back().any()) return NoSuchThing(scene, std::to_string(id));
  }
  if (all.empty()) return Refuse(Error::kMalformed, "remove needs a name or an id: remove BOX_1");
  std::vector<PointLight> lights = scene.lights;
  std::vector<int> dark;
  std::string names;
  const auto once = [](auto& list, auto id) {
    if (std::ranges::find(list, id) == list.end()) list.push_back(id);
  };
  for (const Found& found : all) {
    if (found.object >= 0) {
      once(edit.change.gone_objects, ObjectAt(scene, found.object).id);
      AddTo(names, ObjectAt(scene, found.object).object.name);
    } else if (found.robot >= 0) {
      once(edit.change.gone_robots, RobotAt(scene, found.robot).id);
      AddTo(names, RobotAt(scene, found.robot).entry.name);
    } else if (found.target >= 0) {
      const Target& target = scene.targets[static_cast<std::size_t>(found.target)];
      once(edit.change.gone_targets, target.id);
      AddTo(names, TargetName(target));
    } else {
      once(dark, found.light);
      AddTo(names, scene.lights[static_cast<std::size_t>(found.light)].name);
    }
  }
  std::ranges::sort(dark, std::greater<>());
  for (const int place : dark) lights.erase(lights.begin() + place);
  if (!dark.empty()) edit.change.lights = std::move(lights);
  edit.change.label = "remove " + names;
  return edit;
}

ResolvedEdit ResolveSetPose(const Frame& frame, const std::string& name, std::span<const std::int32_t> ids,
                            std::span<const double> values) {
  const Scene& scene = *frame.scene;
  const Found found = name.empty() && !ids.empty() ? FindId(scene, ids.front()) : FindName(scene, name);
  if (!found.any())
    return NoSuchThing(scene, name.empty() && !ids.empty() ? std::to_string(ids.front()) : name);
  if (values.size() < 2 || values.size() == 5 || values.size() == 6 || values.size() > 7) {
    return Refuse(
        Error::kOutOfRange,
        "set_pose takes x y, x y z, x y z and a yaw, or x y z and a quaternion w x y z: set_pose BOX_1 2 1 "
        "0.25 0");
  }
  const std::span<const double> turn = values.subspan(std::min<std::size_t>(3, values.size()));
  // Values that are not given stay unchanged.
  Pose X_W;
  if (found.object >= 0) X_W = ObjectNow(frame, ObjectAt(scene, found.object)).X_WO;
  if (found.robot >= 0) X_W = RobotNow(frame, found.robot).X_WR;
  if (found.target >= 0) X_W.p = scene.targets[static_cast<std::size_t>(found.target)].p_WT;
  if (found.light >= 0) X_W.p = scene.lights[static_cast<std::size_t>(found.light)].p_WP;
  X_W.p = {values[0], values[1], values.size() > 2 ? values[2] : X_W.p.z()};
  const bool far = !X_W.p.allFinite() || X_W.p.cwiseAbs().maxCoeff() > kMaxFileLength_m;
  if (far) return Refuse(Error::kOutOfRange, "a place is within 100 km of the origin");
  std::optional<Quaternion> q;
  if (turn.size() == 1) q = FromRollPitchYaw(0, 0, turn[0]);
  if (turn.size() == 4) q = Quaternion(turn[0], turn[1], turn[2], turn[3]);
  if (q && !(std::abs(q->norm() - 1) < 1e-3)) {
    return Refuse(Error::kOutOfRange, "a quaternion w x y z has length 1, for example 1 0 0 0");
  }
  if (turn.size() == 4 && std::abs(q->norm() - 1) > 1e-12) q->normalize();
  X_W.q = q.value_or(X_W.q);
  ResolvedEdit edit;
  edit.change.label = "move " + AddMove(frame, found, X_W, edit.change);
  return edit;
}

ResolvedEdit ResolveRename(const Frame& frame, const std::string& text) {
  const Scene& scene = *frame.scene;
  const std::vector<std::string> words = SplitWords(text);
  if (words.size() != 2) {
    return Refuse(Error::kMalformed, "rename needs a name and the new one: rename BOX_1 crate");
  }
  const Found found = FindName(scene, words[0]);
  if (!found.any()) return NoSuchThing(scene, words[0]);
  if (found.target >= 0) {
    return Refuse(Error::kNotPossible, "a target is called by its colour: set " + words[0] + " color green");
  }
  const std::string to = found.robot >= 0 && words[1].starts_with('/') ? words[1].substr(1) : words[1];
  ResolvedEdit edit;
  const NamedKind kind = found.robot >= 0   ? NamedKind::kRobot
                         : found.light >= 0 ? NamedKind::kLight
                                            : NamedKind::kThing;
  if (std::string why = WhyNoName(to, kind); !why.empty()) return Refuse(Error::kMalformed, std::move(why));
  if (found.object >= 0) {
    PutObject put{ObjectAt(scene, found.object).id, ObjectAt(scene, found.object).object, Placing::kKeep};
    put.object.name = to;
    edit.change.objects.push_back(std::move(put));
  } else if (found.robot >= 0) {
    PutRobot put{RobotAt(scene, found.robot).id, RobotAt(scene, found.robot).entry, Placing::kKeep};
    put.entry.name = to;
    edit.change.robots.push_back(std::move(put));
  } else {
    edit.change.lights = scene.lights;
    (*edit.change.lights)[static_cast<std::size_t>(found.light)].name = to;
  }
  edit.change.label = "rename " + words[0] + " " + to;
  return edit;
}

std::vector<std::int32_t> IdsOf(const WorldChange& change) {
  std::vector<std::int32_t> ids;
  const auto add = [&ids](std::uint32_t id, std::int32_t kind) {
    ids.push_back(kind + static_cast<std::int32_t>(id));
  };
  for (const PutObject& put : change.objects) add(put.id.value, 0);
  for (const PutRobot& put : change.robots) add(put.id.value, WorldId::kRobots);
  for (const Target& target : change.targets) add(target.id.value, WorldId::kTargets);
  for (const ObjectId id : change.gone_objects) add(id.value, 0);
  for (const RobotId id : change.gone_robots) add(id.value, WorldId::kRobots);
  for (const TargetId id : change.gone_targets) add(id.value, WorldId::kTargets);
  return ids;
}

std::string NamesOf(const WorldChange& change) {
  std::string names;
  for (const PutObject& put : change.objects) AddTo(names, put.object.name);
  for (const PutRobot& put : change.robots) AddTo(names, put.entry.name);
  for (const Target& target : change.targets) AddTo(names, TargetName(target));
  return names;
}

}  // namespace coopdyn
