// SPDX-License-Identifier: MIT
#include "server/control/world_parts.h"

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

#include "server/base/printable.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

template <typename Things>
int PlaceOf(const Things& things, std::uint32_t id) {
  const auto found = std::ranges::find(things, id, [](const auto& thing) { return thing.id.value; });
  return found == things.end() ? -1 : static_cast<int>(found - things.begin());
}

/// Differs from where it is now by no more than rounding.
bool IsThere(const Pose& a, const Pose& b) {
  constexpr double kTiny = 1e-12;
  return (a.p - b.p).cwiseAbs().maxCoeff() < kTiny && a.q.angularDistance(b.q) < 1e-9;
}

}  // namespace

ResolvedEdit Refuse(Error error, std::string text) {
  return {{}, error, std::move(text)};
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

std::string Lined(const Diagnostics& diagnostics) {
  std::string text = diagnostics.ToString();
  if (!text.empty()) text.pop_back();
  return text;
}

void AddTo(std::string& names, const std::string& name) {
  names += (names.empty() ? "" : " ") + name;
}

}  // namespace coopdyn
