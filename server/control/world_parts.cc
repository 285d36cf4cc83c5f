// SPDX-License-Identifier: MIT
#include "server/control/world_parts.h"

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

#include "server/base/printable.h"
#include "server/model/values.h"

namespace coopdyn {

ResolvedEdit Refuse(Error error, std::string text) {
  return {{}, error, std::move(text)};
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
  // A colour alone is enough for the only target of that colour.
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

std::string WithLines(std::string text) {
  if (text.find('\n') != std::string::npos) return text;
  for (std::size_t bar = 0; (bar = text.find('|', bar)) != std::string::npos; ++bar) {
    const bool alone = (bar == 0 || text[bar - 1] == ' ') && (bar + 1 == text.size() || text[bar + 1] == ' ');
    if (alone) text[bar] = '\n';
  }
  // "[BOX_1] type box": puts the rest on its own line.
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
