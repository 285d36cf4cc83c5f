// SPDX-License-Identifier: MIT
#include "server/model/scenario.h"

#include <algorithm>
#include <map>

#include "server/model/values.h"

namespace coopdyn {

namespace {

template <typename Words, typename Enum>
const char* WordOf(const Words& words, Enum value) {
  const auto index = static_cast<std::size_t>(value);
  return words[index < words.size() ? index : 0].c_str();
}

template <typename Enum, typename Words>
std::optional<Enum> Parse(const Words& words, const std::string& word) {
  const auto found = std::find(words.begin(), words.end(), ToLower(word));
  if (found == words.end()) return std::nullopt;
  return static_cast<Enum>(found - words.begin());
}

// --- the summary

std::string Counted(std::size_t count, const std::string& noun) {
  if (count == 0) return "no " + noun + "s";
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// "swarm ant" or "3 swarms".
std::string Swarms(const Scenario& scenario) {
  const std::size_t count = scenario.swarms.size();
  return count == 1 ? "swarm " + scenario.swarms[0].name : std::to_string(count) + " swarms";
}

/// How the robots are simulated and driven, without defaults: "rolling", "50 controller diffuse".
std::vector<std::string> Drives(const std::vector<RobotEntry>& robots) {
  std::map<std::string, std::size_t> fidelities, controllers;
  for (const RobotEntry& robot : robots) {
    if (robot.fidelity != Fidelity::kFull) ++fidelities[ToString(robot.fidelity)];
    if (!robot.controller.empty()) ++controllers["controller " + robot.controller.name];
  }
  std::vector<std::string> texts;
  for (const auto& counts : {fidelities, controllers}) {
    for (const auto& [text, count] : counts) {
      texts.push_back(count == robots.size() ? text : std::to_string(count) + " " + text);
    }
  }
  return texts;
}

}  // namespace

std::vector<std::string> RobotEntry::awaited_modules() const {
  std::vector<std::string> awaited = model->actuator_modules();
  if (model->is_only_observed()) awaited = {""};
  if (waits_for.empty()) return awaited;
  std::erase_if(awaited, [this](const std::string& name) {
    return std::find(waits_for.begin(), waits_for.end(), name) == waits_for.end();
  });
  return awaited;
}

const char* ToString(Mode mode) {
  return WordOf(kModeWords, mode);
}

const char* ToString(LossPolicy policy) {
  return WordOf(kLossPolicyWords, policy);
}

const char* ToString(Fidelity fidelity) {
  return WordOf(kFidelityWords, fidelity);
}

std::optional<Mode> ParseMode(const std::string& word) {
  return Parse<Mode>(kModeWords, word);
}

std::optional<Fidelity> ParseFidelity(const std::string& word) {
  return Parse<Fidelity>(kFidelityWords, word);
}

bool CountsCollisions(const Scenario& scenario) {
  return std::ranges::any_of(scenario.scores,
                             [](const ScoreEntry& one) { return one.kind == ScoreKind::kCollisions; });
}

std::string Summary(const Scenario& scenario) {
  std::map<std::string, std::size_t> types;
  for (const RobotEntry& robot : scenario.robots) ++types[robot.model->type];
  std::vector<std::string> type_texts;
  for (const auto& [type, count] : types) {
    type_texts.push_back(types.size() == 1 ? type : std::to_string(count) + " " + type);
  }
  std::string out = Counted(scenario.robots.size(), "robot");
  if (!scenario.swarms.empty()) out += " in " + Swarms(scenario);
  if (!types.empty()) {
    out += " (" + JoinNames(type_texts);
    for (const std::string& text : Drives(scenario.robots)) out += ", " + text;
    out += ")";
  }

  const auto fixed = std::count_if(scenario.objects.begin(), scenario.objects.end(),
                                   [](const WorldObject& object) { return object.is_static(); });
  out += ", " + Counted(scenario.objects.size(), "object");
  if (!scenario.objects.empty()) out += " (" + std::to_string(fixed) + " static)";

  const Nanoseconds step = scenario.simulation.step.value_or(kDefaultStep);
  out += ", " + Counted(scenario.targets.size(), "target");
  if (!scenario.lights.empty()) out += ", " + Counted(scenario.lights.size(), "light");
  out += ", floor " + FormatNumber(scenario.floor.length_m) + " x " + FormatNumber(scenario.floor.width_m) +
         " m";
  out += std::string(", ") + ToString(scenario.simulation.mode.value_or(Mode::kRealtime)) + " " +
         FormatNumber(static_cast<double>(step) / 1e6) + " ms";
  if (const ControllerChoice& supervisor = scenario.simulation.supervisor; !supervisor.empty())
    out += ", supervisor " + supervisor.name;
  return out;
}

}  // namespace coopdyn
