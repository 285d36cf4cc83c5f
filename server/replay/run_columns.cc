// SPDX-License-Identifier: MIT
#include "server/replay/run_columns.h"

#include <algorithm>
#include <functional>
#include <map>
#include <unordered_set>

#include "server/model/values.h"
#include "server/record/run_tables.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

using Names = std::vector<std::string>;

/// Lists the names to choose from, for an error message.
std::string Listed(const Names& known, const std::string& plural) {
  constexpr std::size_t kListed = 20;
  if (known.empty()) return ": this run has no " + plural;
  Names listed(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(std::min(known.size(), kListed)));
  const bool all = listed.size() == known.size();
  return ": there are " + JoinNames(listed) +
         (all ? "" : " … (" + std::to_string(known.size()) + " " + plural + ")");
}

/// Suggests a name instead of `word`, for an error message.
std::string Instead(const std::string& word, const Names& known, const std::string& plural) {
  const std::string near = Nearest(word, known);
  return near.empty() ? Listed(known, plural) : "; did you mean '" + near + "'?";
}

/// The robots that `word` names: one, or those of a swarm; empty if it names none.
Names RobotsCalled(const std::string& word, const std::unordered_set<std::string>& robots,
                   const Scenario* scenario) {
  if (robots.contains(word)) return {word};
  Names members;
  if (scenario == nullptr) return members;
  for (const SwarmEntry& swarm : scenario->swarms) {
    if (swarm.name != word && swarm.section != word) continue;
    for (std::size_t i = 1; i <= swarm.count; ++i) {
      if (std::string name = swarm.name + "_" + std::to_string(i); robots.contains(name)) {
        members.push_back(std::move(name));
      }
    }
  }
  return members;
}

void ChooseRobots(const Names& words, const Scenario* scenario, std::vector<RobotColumn>& robots,
                  std::string& error) {
  std::unordered_set<std::string> known, chosen;
  Names names;
  for (const RobotColumn& robot : robots) {
    known.insert(robot.name);
    names.push_back(robot.name);
  }
  for (const std::string& word : words) {
    const Names called = RobotsCalled(word, known, scenario);
    if (called.empty()) {
      error = "there is no robot '" + word + "' in this part of the run" + Instead(word, names, "robots");
      return;
    }
    chosen.insert(called.begin(), called.end());
  }
  std::erase_if(robots, [&](const RobotColumn& robot) { return !chosen.contains(robot.name); });
}

void ChooseObjects(const Names& words, const std::unordered_set<std::string>& fixed, Names& objects,
                   std::string& error) {
  for (const std::string& word : words) {
    if (std::find(objects.begin(), objects.end(), word) != objects.end()) continue;
    const std::string plural = "things that move";
    error = fixed.contains(word) ? "'" + word + "' never moves" + Listed(objects, plural)
                                 : "there is no thing '" + word + "' that moves in this part of the run" +
                                       Instead(word, objects, plural);
    return;
  }
  std::erase_if(objects, [&](const std::string& name) {
    return std::find(words.begin(), words.end(), name) == words.end();
  });
}

bool IsIn(const std::string& name, const Names& names) {
  return std::ranges::find(names, name) != names.end();
}

/// Keeps the columns that `words` name.
template <typename Column, typename NameOf>
void ChooseNumbers(const Names& words, const std::string& what, std::vector<Column>& columns, NameOf name_of,
                   std::string& error) {
  Names known;
  for (const Column& column : columns) known.push_back(std::invoke(name_of, column));
  for (const std::string& word : words) {
    if (IsIn(word, known)) continue;
    error =
        "there is no " + what + " '" + word + "' in this part of the run" + Instead(word, known, what + "s");
    return;
  }
  std::erase_if(columns, [&](const Column& column) { return !IsIn(std::invoke(name_of, column), words); });
}

/// The sensors of `model` that `words` name. Adds all possible names to `known`.
std::vector<ReadingColumn> ReadingsOf(const RobotModel& model, const Names& words, Names& known) {
  std::vector<ReadingColumn> readings;
  for (const SensorModel& sensor : model.sensors) {
    if (FixedCount(sensor.kind) == 0) continue;
    const auto names = [&sensor](const std::string& word) {
      return word == sensor.name || word == sensor.type();
    };
    if (std::ranges::any_of(words, names)) readings.push_back({sensor.name, FixedNames(sensor.kind)});
    for (const std::string& name : {sensor.name, std::string(sensor.type())}) {
      if (std::ranges::find(known, name) == known.end()) known.push_back(name);
    }
  }
  return readings;
}

/// Sets the labels: red1, red2, blue1 …
void LabelTargets(std::vector<TargetColumn>& targets) {
  std::sort(targets.begin(), targets.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  std::map<std::string, int> seen;
  for (TargetColumn& target : targets) target.label = target.color + std::to_string(++seen[target.color]);
}

}  // namespace

RunColumns ChooseColumns(std::span<const std::shared_ptr<const Scene>> scenes, const RunNumbers& numbers,
                         const ExportOptions& options, std::string& error) {
  RunColumns columns;
  std::unordered_set<std::string> robots, objects, fixed;
  std::unordered_set<std::uint32_t> targets;
  Names modules;  // names accepted in options.readings
  for (const auto& scene : scenes) {
    for (const SceneRobot& robot : scene->robots) {
      if (!robots.insert(robot.entry.name).second) continue;
      const RobotModel& model = *robot.entry.model;
      columns.robots.push_back({robot.entry.name,
                                model.type,
                                model.sector_count(),
                                {},
                                ReadingsOf(model, options.readings, modules)});
      for (int i = robot.first_channel; i < robot.first_channel + robot.channel_count; ++i) {
        const auto channel = static_cast<std::size_t>(i);
        columns.robots.back().channels.push_back(
            {ChannelName(*scene, channel), ChannelUnit(*scene, channel), {}});
      }
    }
    for (const SceneObject& object : scene->objects) {
      if (object.body < 0) {
        fixed.insert(object.object.name);
      } else if (objects.insert(object.object.name).second) {
        columns.objects.push_back(object.object.name);
      }
    }
    for (const Target& target : scene->targets) {
      if (!targets.insert(target.id.value).second) continue;
      columns.targets.push_back({target.id, "", target.color_name, target.p_WT});
    }
  }
  LabelTargets(columns.targets);
  const Scenario* scenario = scenes.empty() ? nullptr : scenes.front()->scenario.get();
  for (const std::string& word : options.readings) {
    if (!error.empty() || std::ranges::find(modules, word) != modules.end()) continue;
    error =
        "no robot in this part of the run has a sensor '" + word + "'" + Instead(word, modules, "sensors");
  }
  if (options.robots && error.empty()) ChooseRobots(*options.robots, scenario, columns.robots, error);
  if (options.objects && error.empty()) ChooseObjects(*options.objects, fixed, columns.objects, error);
  if (scenario != nullptr && numbers.scores) {
    for (const ScoreEntry& score : scenario->scores)
      columns.scores.push_back({score.name, UnitOf(score.kind), columns.scores.size()});
  }
  columns.logged = numbers.logged;
  if (options.scores && error.empty())
    ChooseNumbers(*options.scores, "score", columns.scores, &ScoreColumn::name, error);
  if (options.logged && error.empty())
    ChooseNumbers(*options.logged, "logged number", columns.logged, std::identity(), error);
  return columns;
}

}  // namespace coopdyn
