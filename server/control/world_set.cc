// SPDX-License-Identifier: MIT
// The edit `set`: changes the values of some keys of a thing.
#include <algorithm>
#include <utility>

#include "server/base/printable.h"
#include "server/control/world_parts.h"
#include "server/model/scenario_writer.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Keeps the height of the bottom after a change of `object`: it still stands on what is below it.
void KeepBottom(const WorldObject& was, WorldObject& object) {
  object.X_WO.p.z() += HalfExtents(object.shape, object.X_WO.q).z() - HalfExtents(was.shape, was.X_WO.q).z();
}

/// New values for some keys of a section.
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
  WorldObject now = ObjectNow(frame, thing);
  now.v_WO = now.w_WO = Vector3::Zero();  // at rest unless the keys say otherwise
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
  const bool is_thrown = keys.Has("velocity") || keys.Has("turn_rate");
  if (resized || keys.Places() || is_thrown) put.placing = Placing::kStart;
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
  const auto read =
      ReadInsertion(keys.Replace(WriteRobot(now, 1, now.model->type)), robots, nothing, diagnostics);
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
  // Uses a name that every reader recognises as a light's.
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

}  // namespace

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

}  // namespace coopdyn
