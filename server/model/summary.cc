// SPDX-License-Identifier: MIT
#include "server/model/summary.h"

#include <algorithm>
#include <map>
#include <vector>

#include "server/model/values.h"

namespace coopdyn {

namespace {

std::string Counted(std::size_t count, const std::string& noun) {
  if (count == 0) return "no " + noun + "s";
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

std::string Summary(const Scenario& scenario) {
  std::map<std::string, std::size_t> types;
  for (const RobotEntry& robot : scenario.robots) ++types[robot.model->type];
  std::vector<std::string> type_texts;
  for (const auto& [type, count] : types) {
    type_texts.push_back(types.size() == 1 ? type : std::to_string(count) + " " + type);
  }
  std::string out = Counted(scenario.robots.size(), "robot");
  if (!types.empty()) out += " (" + JoinNames(type_texts) + ")";

  const auto fixed = std::count_if(scenario.objects.begin(), scenario.objects.end(),
                                   [](const WorldObject& object) { return object.is_static(); });
  out += ", " + Counted(scenario.objects.size(), "object");
  if (!scenario.objects.empty()) out += " (" + std::to_string(fixed) + " static)";

  const Nanoseconds step = scenario.simulation.step.value_or(kDefaultStep);
  out += ", " + Counted(scenario.targets.size(), "target");
  out += ", floor " + FormatNumber(scenario.floor.length_m) + " x " + FormatNumber(scenario.floor.width_m) +
         " m";
  out += std::string(", ") + ToString(scenario.simulation.mode.value_or(Mode::kRealtime)) + " " +
         FormatNumber(static_cast<double>(step) / 1e6) + " ms";
  return out;
}

}  // namespace coopdyn
