// SPDX-License-Identifier: MIT
#include "server/control/world_edits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <unordered_set>
#include <utility>

#include "server/base/printable.h"
#include "server/model/scenario_writer.h"
#include "server/model/section_reader.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

ResolvedEdit Refuse(Error error, std::string text) {
  return {{}, error, std::move(text)};
}

/// What a name or an id means: indices into the scene; all -1: nothing.
struct Found {
  int object = -1, robot = -1, target = -1, light = -1;
  bool any() const { return object >= 0 || robot >= 0 || target >= 0 || light >= 0; }
};

template <typename Things>
int PlaceOf(const Things& things, std::uint32_t id) {
  const auto found = std::ranges::find(things, id, [](const auto& thing) { return thing.id.value; });
  return found == things.end() ? -1 : static_cast<int>(found - things.begin());
}

Found FindId(const Scene& scene, std::int32_t id) {
  const auto value = static_cast<std::uint32_t>(id % WorldId::kRobots);
  Found found;
  if (id <= 0) return found;
  switch (id / WorldId::kRobots) {
    case 0:
      found.object = PlaceOf(scene.objects, value);
      break;
    case 1:
      found.robot = PlaceOf(scene.robots, value);
      break;
    case 2:
      found.target = PlaceOf(scene.targets, value);
      break;
    case 3:
      if (value >= 1 && value <= scene.lights.size()) found.light = static_cast<int>(value) - 1;
      break;
    default:
      break;
  }
  return found;
}

Found FindName(const Scene& scene, std::string_view word) {
  Found found;
  std::int32_t id = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), id);
  if (error == std::errc() && end == word.data() + word.size()) return FindId(scene, id);
  if (word.starts_with('/')) word.remove_prefix(1);
  const std::string name = ToLower(word);
  const auto place = [&name](const auto& things, auto name_of) {
    const auto it =
        std::ranges::find_if(things, [&](const auto& thing) { return ToLower(name_of(thing)) == name; });
    return it == things.end() ? -1 : static_cast<int>(it - things.begin());
  };
  found.object = place(scene.objects, [](const SceneObject& thing) { return thing.object.name; });
  if (found.any()) return found;
  found.robot = place(scene.robots, [](const SceneRobot& robot) { return robot.entry.name; });
  if (found.any()) return found;
  found.target = place(scene.targets, [](const Target& target) { return TargetName(target); });
  if (found.any()) return found;
  found.light = place(scene.lights, [](const PointLight& light) { return light.name; });
  if (found.any()) return found;
  // A target alone of its colour needs no number.
  const auto is_it = [&name](const Target& target) { return target.color_name == name; };
  if (std::ranges::count_if(scene.targets, is_it) == 1) {
    found.target = static_cast<int>(std::ranges::find_if(scene.targets, is_it) - scene.targets.begin());
  }
  return found;
}

ResolvedEdit NoSuchThing(const Scene& scene, std::string_view word) {
  std::vector<std::string> known;
  for (const SceneObject& thing : scene.objects) known.push_back(thing.object.name);
  for (const SceneRobot& robot : scene.robots) known.push_back(robot.entry.name);
  for (const Target& target : scene.targets) known.push_back(TargetName(target));
  for (const PointLight& light : scene.lights) known.push_back(light.name);
  std::string text = "there is no " + Printable(std::string(word.substr(0, 63))) + " in the world";
  const std::string near = word.size() > 63 ? "" : Nearest(word, known);
  text += near.empty() ? ": list shows what there is" : ": did you mean " + near + "?";
  return Refuse(Error::kNoSuchName, std::move(text));
}

const SceneObject& ObjectAt(const Scene& scene, int place) {
  return scene.objects[static_cast<std::size_t>(place)];
}
const SceneRobot& RobotAt(const Scene& scene, int place) {
  return scene.robots[static_cast<std::size_t>(place)];
}

/// Differs from where it is now by no more than rounding.
bool IsThere(const Pose& a, const Pose& b) {
  constexpr double kTiny = 1e-12;
  return (a.p - b.p).cwiseAbs().maxCoeff() < kTiny && a.q.angularDistance(b.q) < 1e-9;
}

/// The description of a thing with its present place; one that was not moved has the very numbers it had.
WorldObject ObjectNow(const Frame& frame, const SceneObject& thing) {
  WorldObject object = thing.object;
  const Pose now = ObjectPose(frame, thing);
  if (!IsThere(now, object.X_WO)) object.X_WO = {now.p, now.q.normalized()};
  return object;
}
RobotEntry RobotNow(const Frame& frame, int place) {
  RobotEntry entry = RobotAt(*frame.scene, place).entry;
  const Pose now = RobotPose(frame, place);
  if (!IsThere(now, entry.X_WR)) entry.X_WR = {now.p, now.q.normalized()};
  // One that stands has sunk in a little; a place below the floor is none.
  constexpr double kSunk_m = 5e-3;
  if (entry.X_WR.p.z() < 0 && entry.X_WR.p.z() > -kSunk_m) entry.X_WR.p.z() = 0;
  return entry;
}

/// All that stands there now, as a scenario.
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

std::string WithLines(std::string text) {
  if (text.find('\n') != std::string::npos) return text;
  for (std::size_t bar = 0; (bar = text.find('|', bar)) != std::string::npos; ++bar) {
    const bool alone = (bar == 0 || text[bar - 1] == ' ') && (bar + 1 == text.size() || text[bar + 1] == ' ');
    if (alone) text[bar] = '\n';
  }
  // [BOX_1] type box: the rest of the line is a line of its own.
  std::string lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = Trim(std::string_view(text).substr(at, end - at));
    if (line.starts_with('[')) {
      const std::size_t close = line.find(']');
      if (close != std::string_view::npos) {
        lines += std::string(line.substr(0, close + 1)) + "\n";
        line.remove_prefix(close + 1);
      }
    }
    lines += std::string(Trim(line)) + "\n";
    at = end + 1;
  }
  return lines;
}

/// [NAME_*] with the next number that is free, each of them.
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

std::string Lined(const Diagnostics& diagnostics) {
  std::string text = diagnostics.ToString();
  if (!text.empty()) text.pop_back();
  return text;
}

/// `object` after its section was changed: what stood on something still does.
void KeepBottom(const WorldObject& was, WorldObject& object) {
  object.X_WO.p.z() += HalfExtents(object.shape, object.X_WO.q).z() - HalfExtents(was.shape, was.X_WO.q).z();
}

/// A section's text with other values of some keys.
struct Keys {
  std::vector<std::pair<std::string, std::string>> values;
  bool Has(std::string_view key) const {
    return std::ranges::any_of(values, [&](const auto& value) { return value.first == key; });
  }
  bool Places() const { return Has("position") || Has("orientation") || Has("quaternion"); }

  std::string Replace(const std::string& section) const {
    std::string text;
    for (std::size_t at = 0; at < section.size();) {
      const std::size_t end = section.find('\n', at);
      const std::string line = section.substr(at, end - at);
      const std::string key = line.substr(0, line.find(' '));
      const bool turn = key == "orientation" || key == "quaternion";
      if (!Has(key) && !(turn && (Has("orientation") || Has("quaternion")))) text += line + "\n";
      at = end + 1;
    }
    for (const auto& [key, value] : values) text += key + " " + value + "\n";
    return text;
  }
};

ResolvedEdit SetObject(const Frame& frame, const SceneObject& thing, const Keys& keys, RobotLibrary& robots) {
  const WorldObject now = ObjectNow(frame, thing);
  Scenario nothing;
  Diagnostics diagnostics;
  const auto read = ReadInsertion(keys.Replace(WriteObject(now)), robots, nothing, diagnostics);
  if (read == nullptr || read->objects.size() != 1) {
    std::string text = Lined(diagnostics);
    if (text.empty()) text = "'count' is for new things: insert takes it";
    return Refuse(Error::kMalformed, std::move(text));
  }
  PutObject put{thing.id, read->objects.front(), Placing::kKeep};
  put.object.where = thing.object.where;
  if (put.object.texture.image == nullptr && !keys.Has("texture")) put.object.texture = now.texture;
  const bool resized = !(put.object.shape == now.shape);
  if (resized && !keys.Has("position")) KeepBottom(now, put.object);
  if (resized || keys.Places()) put.placing = Placing::kStart;
  ResolvedEdit edit;
  edit.change.objects.push_back(std::move(put));
  edit.text = Lined(diagnostics);
  return edit;
}

ResolvedEdit SetRobot(const Frame& frame, int place, const Keys& keys, RobotLibrary& robots) {
  const RobotEntry now = RobotNow(frame, place);
  if (!IsBareName(now.model->type)) robots.Add(now.model->type, now.model);
  Scenario nothing;
  Diagnostics diagnostics;
  const auto read = ReadInsertion(keys.Replace(WriteRobot(now, 1)), robots, nothing, diagnostics);
  if (read == nullptr || read->robots.size() != 1) {
    std::string text = Lined(diagnostics);
    if (text.empty()) text = "a robot cannot become a team: insert takes type team2";
    return Refuse(Error::kMalformed, std::move(text));
  }
  PutRobot put{RobotAt(*frame.scene, place).id, read->robots.front(),
               keys.Places() ? Placing::kStart : Placing::kKeep};
  put.entry.where = now.where;
  if (!keys.Has("type")) put.entry.model = now.model;
  ResolvedEdit edit;
  edit.change.robots.push_back(std::move(put));
  edit.text = Lined(diagnostics);
  return edit;
}

ResolvedEdit SetTarget(Target target, const Keys& keys, RobotLibrary& robots) {
  for (const auto& [key, value] : keys.values) {
    if (key == "color") {
      if (!NamedColor(value)) {
        return Refuse(Error::kMalformed, "a target's colour is a word, not '" + Printable(value) +
                                             "', for example: color green");
      }
      target.color_name = ToLower(value);
    } else if (key == "position") {
      Scenario nothing;
      Diagnostics diagnostics;
      const auto read =
          ReadInsertion("[TARGET]\n" + target.color_name + " " + value + "\n", robots, nothing, diagnostics);
      if (read == nullptr) return Refuse(Error::kMalformed, Lined(diagnostics));
      target.p_WT = read->targets.front().p_WT;
    } else {
      return Refuse(Error::kMalformed, "a target has the keys color and position, not '" + key + "'");
    }
  }
  target.color = NamedColor(target.color_name).value_or(target.color);
  ResolvedEdit edit;
  edit.change.targets.push_back(std::move(target));
  return edit;
}

ResolvedEdit SetLight(const Scene& scene, int place, const Keys& keys, RobotLibrary& robots) {
  std::vector<PointLight> lights = scene.lights;
  PointLight& light = lights[static_cast<std::size_t>(place)];
  // By a name that every reader takes for a light's.
  PointLight named = light;
  named.name = "LIGHT_1";
  Scenario nothing;
  Diagnostics diagnostics;
  const auto read = ReadInsertion(keys.Replace(WriteLight(named)), robots, nothing, diagnostics);
  if (read == nullptr) return Refuse(Error::kMalformed, Lined(diagnostics));
  const std::string name = light.name;
  light = read->lights.front();
  light.name = name;
  ResolvedEdit edit;
  edit.change.lights = std::move(lights);
  return edit;
}

void AddTo(std::string& names, const std::string& name) {
  names += (names.empty() ? "" : " ") + name;
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
  const auto at = [&values](double z) {
    return Vector3(values[0], values[1], values.size() > 2 ? values[2] : z);
  };
  const Vector3 p_W = at(0);
  const bool far = !p_W.allFinite() || p_W.cwiseAbs().maxCoeff() > kMaxFileLength_m;
  if (far) return Refuse(Error::kOutOfRange, "a place is within 100 km of the origin");
  std::optional<Quaternion> q;
  if (turn.size() == 1) q = FromRollPitchYaw(0, 0, turn[0]);
  if (turn.size() == 4) q = Quaternion(turn[0], turn[1], turn[2], turn[3]);
  if (q && !(std::abs(q->norm() - 1) < 1e-3)) {
    return Refuse(Error::kOutOfRange, "a quaternion w x y z has length 1, for example 1 0 0 0");
  }
  if (turn.size() == 4 && std::abs(q->norm() - 1) > 1e-12) q->normalize();
  ResolvedEdit edit;
  if (found.object >= 0) {
    const SceneObject& thing = ObjectAt(scene, found.object);
    PutObject put{thing.id, ObjectNow(frame, thing), Placing::kStart};
    put.object.X_WO = {at(put.object.X_WO.p.z()), q.value_or(put.object.X_WO.q)};
    edit.change.label = "move " + thing.object.name;
    edit.change.objects.push_back(std::move(put));
  } else if (found.robot >= 0) {
    PutRobot put{RobotAt(scene, found.robot).id, RobotNow(frame, found.robot), Placing::kStart};
    put.entry.X_WR = {at(put.entry.X_WR.p.z()), q.value_or(put.entry.X_WR.q)};
    edit.change.label = "move " + put.entry.name;
    edit.change.robots.push_back(std::move(put));
  } else if (found.target >= 0) {
    Target target = scene.targets[static_cast<std::size_t>(found.target)];
    target.p_WT = at(target.p_WT.z());
    edit.change.label = "move " + TargetName(target);
    edit.change.targets.push_back(std::move(target));
  } else {
    edit.change.lights = scene.lights;
    PointLight& light = (*edit.change.lights)[static_cast<std::size_t>(found.light)];
    light.p_WP = at(light.p_WP.z());
    edit.change.label = "move " + light.name;
  }
  return edit;
}

ResolvedEdit ResolveSet(const Frame& frame, const std::string& text, RobotLibrary& robots) {
  const Scene& scene = *frame.scene;
  const std::size_t blank = text.find_first_of(" \t\n");
  const std::string name = text.substr(0, blank);
  Keys keys;
  std::string rest = blank == std::string::npos ? "" : WithLines(text.substr(blank + 1));
  for (std::size_t at = 0; at < rest.size();) {
    const std::size_t end = std::min(rest.find('\n', at), rest.size());
    const std::string line(Trim(std::string_view(rest).substr(at, end - at)));
    at = end + 1;
    if (line.empty()) continue;
    const std::size_t space = line.find_first_of(" \t=:");
    std::string key = ToLower(line.substr(0, space));
    if (key == "colour") key = "color";
    const std::string value =
        space == std::string::npos
            ? ""
            : std::string(Trim(std::string_view(line).substr(line.find_first_not_of(" \t=:", space))));
    if (value.empty()) {
      return Refuse(Error::kMalformed,
                    "set needs a value for '" + Printable(key) + "': set " + Printable(name) + " color red");
    }
    if (keys.Has(key)) return Refuse(Error::kMalformed, "'" + Printable(key) + "' stands twice: keep one");
    if (key == "name")
      return Refuse(Error::kMalformed, "rename gives another name: rename " + Printable(name) + " NEW_NAME");
    keys.values.emplace_back(std::move(key), value);
  }
  if (keys.values.empty()) {
    return Refuse(Error::kMalformed, "set needs a name, a key and its values: set BOX_1 color red");
  }
  const Found found = FindName(scene, name);
  const std::string lower = ToLower(name);
  if (!found.any() && (lower == "floor" || lower == "simulation" || lower == "world")) {
    return Refuse(Error::kNotPossible,
                  "[" + name + "] cannot be changed while the world stands: save, edit the text and load it");
  }
  if (!found.any()) return NoSuchThing(scene, name);
  ResolvedEdit edit;
  std::string title = name;
  if (found.object >= 0) {
    edit = SetObject(frame, ObjectAt(scene, found.object), keys, robots);
    title = ObjectAt(scene, found.object).object.name;
  } else if (found.robot >= 0) {
    edit = SetRobot(frame, found.robot, keys, robots);
    title = RobotAt(scene, found.robot).entry.name;
  } else if (found.target >= 0) {
    edit = SetTarget(scene.targets[static_cast<std::size_t>(found.target)], keys, robots);
    title = TargetName(scene.targets[static_cast<std::size_t>(found.target)]);
  } else {
    edit = SetLight(scene, found.light, keys, robots);
  }
  edit.change.label = "set " + title;
  for (const auto& [key, value] : keys.values) edit.change.label += " " + key;
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

std::string WorldText(const Frame& frame, const RunStatus& status) {
  const Scene& scene = *frame.scene;
  SimulationOptions simulation = scene.scenario->simulation;
  simulation.mode = status.mode;
  simulation.step = status.step_length;
  simulation.seed = frame.seed;
  std::string text = "# The world of " + Printable(scene.scenario->name) + " at " +
                     ExactNumber(frame.time_s()) + " s\n" + WriteSimulation(simulation, scene.ambient_light) +
                     "\n" + WriteFloor(scene.floor);
  for (const SceneObject& thing : scene.objects) text += "\n" + WriteObject(ObjectNow(frame, thing));
  for (const PointLight& light : scene.lights) text += "\n" + WriteLight(light);
  if (!scene.targets.empty()) text += "\n" + WriteTargets(scene.targets);
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    text += "\n" + WriteRobot(RobotNow(frame, static_cast<int>(i)), i + 1);
  }
  return text;
}

}  // namespace coopdyn
