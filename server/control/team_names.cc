// SPDX-License-Identifier: MIT
#include "server/control/team_names.h"

#include <algorithm>
#include <unordered_map>

#include "server/devices/module_core.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

using Index = std::unordered_map<std::string_view, int>;

const SwarmEntry* FindSwarm(const Scenario& scenario, const std::string& word) {
  const auto found =
      std::find_if(scenario.swarms.begin(), scenario.swarms.end(),
                   [&](const SwarmEntry& swarm) { return swarm.name == word || swarm.section == word; });
  return found == scenario.swarms.end() ? nullptr : &*found;
}

std::string NoSuch(const Scene& scene, const std::string& word) {
  constexpr std::size_t kShown = 63;  // no name is longer
  constexpr std::size_t kListed = 20;
  std::vector<std::string> known;
  for (const SwarmEntry& swarm : scene.scenario->swarms) known.push_back(swarm.name);
  for (const SceneRobot& robot : scene.robots) known.push_back(robot.entry.name);
  std::string text = "there is no robot and no swarm " + word.substr(0, kShown);
  if (known.empty()) return text + ": this scenario has none";
  const std::string near = word.size() > kShown ? "" : Nearest(word, known);
  if (!near.empty()) return text + ": did you mean " + near + "?";
  const bool all = known.size() <= kListed;
  if (!all) known.resize(kListed);
  return text + ": there are " + (all ? JoinNames(known) : JoinNames(known) + " and more (list shows all)");
}

}  // namespace

NamedRobots FindNamedRobots(const Scene& scene, std::string_view text) {
  const std::vector<std::string> words = Words(text);
  Index index;
  index.reserve(scene.robots.size());
  for (std::size_t i = 0; i < scene.robots.size(); ++i)
    index.emplace(scene.robots[i].entry.name, static_cast<int>(i));
  NamedRobots named;
  std::vector<bool> is_named(scene.robots.size(), false);
  const auto add = [&](const std::string& robot) {
    const auto found = index.find(robot);
    if (found != index.end()) is_named[static_cast<std::size_t>(found->second)] = true;
  };
  for (std::string word : words) {
    if (word.size() > 1 && word.front() == '/') word.erase(0, 1);
    const SwarmEntry* swarm = scene.scenario == nullptr ? nullptr : FindSwarm(*scene.scenario, word);
    if (index.contains(word)) {
      add(word);
    } else if (swarm != nullptr) {
      for (std::size_t i = 1; i <= swarm->count; ++i) add(swarm->name + "_" + std::to_string(i));
    } else {
      named.error = NoSuch(scene, word);
      return named;
    }
  }
  for (std::size_t i = 0; i < is_named.size(); ++i) {
    if (is_named[i]) named.robots.push_back(static_cast<int>(i));
  }
  return named;
}

}  // namespace coopdyn
