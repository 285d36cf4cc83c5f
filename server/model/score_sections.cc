// SPDX-License-Identifier: MIT
#include "server/model/score_sections.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr const char* kUntilExample = "until >= 3, until < 0.5 or until all";

/// True for a valid name: it becomes a table column, and a field in MATLAB.
bool IsScoreName(const std::string& name) {
  constexpr std::size_t kMaxName = 60;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && name.size() <= kMaxName && is_letter(name.front()) &&
         std::ranges::all_of(name,
                             [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

/// Reads `until`: `>= 3` or `all`.
std::optional<ScoreUntil> ReadUntil(SectionReader& reader, ScoreKind kind) {
  using Relation = ScoreUntil::Relation;
  const std::optional<std::string> text = reader.Text("until");
  if (!text) return std::nullopt;
  const auto wrong = [&](const std::string& why) {
    reader.ErrorAt("until", why + ": write " + kUntilExample);
    return std::nullopt;
  };
  if (ToLower(*text) == "all") {
    if (kind != ScoreKind::kReach && kind != ScoreKind::kUpright)
      return wrong("'until all' goes with 'kind reach' and 'kind upright' only");
    // reach: all have arrived; upright: all have fallen.
    if (kind == ScoreKind::kUpright) return ScoreUntil{Relation::kAtMost, 0, false};
    return ScoreUntil{Relation::kAtLeast, 0, true};
  }
  static const std::vector<std::pair<std::string, Relation>> kRelations = {{"<=", Relation::kAtMost},
                                                                           {">=", Relation::kAtLeast},
                                                                           {"<", Relation::kLess},
                                                                           {">", Relation::kGreater}};
  for (const auto& [sign, relation] : kRelations) {
    if (!text->starts_with(sign)) continue;
    const ParsedNumber number = ParseNumber(Trim(text->substr(sign.size())), Quantity::kAny);
    if (!number.error.empty()) return wrong("'until': " + number.error);
    return ScoreUntil{relation, number.value, false};
  }
  return wrong("'until' begins with <, <=, > or >=, or is 'all', not '" + *text + "'");
}

}  // namespace

std::string ToString(const ScoreUntil& until) {
  using Relation = ScoreUntil::Relation;
  if (until.all) return "all";
  const bool less = until.relation == Relation::kLess || until.relation == Relation::kAtMost;
  const bool equal = until.relation == Relation::kAtMost || until.relation == Relation::kAtLeast;
  return std::string(less ? "<" : ">") + (equal ? "= " : " ") + FormatNumber(until.value);
}

const char* UnitOf(ScoreKind kind) {
  switch (kind) {
    case ScoreKind::kTime:
      return "s";
    case ScoreKind::kDistance:
    case ScoreKind::kTravelled:
    case ScoreKind::kNearest:
    case ScoreKind::kFormation:
      return "m";
    case ScoreKind::kEnergy:
      return "J";
    case ScoreKind::kCoverage:
      return "m2";
    default:
      return "";
  }
}

std::optional<ScoreEntry> ReadScore(SectionReader& reader) {
  constexpr double kMaxTilt_rad = std::numbers::pi;
  ScoreEntry score;
  score.where = reader.where();
  reader.Require("kind", "kind reach");
  const auto kind = reader.Choice<ScoreKind>("kind", kScoreKindWords);
  if (kind) score.kind = *kind;
  score.name = kind ? kScoreKindWords[static_cast<std::size_t>(*kind)] : "";
  Take(reader.Word("name"), score.name);
  if (kind && !IsScoreName(score.name)) {
    reader.ErrorAt(
        "name",
        "a score's name is a letter, then letters, digits and _, at most 60, for example: name arrived");
  }
  if (const auto of = reader.Text("of")) score.of = SplitWords(*of);
  const auto only = [&](const char* key, ScoreKind of_kind) {
    if (!reader.Has(key) || !kind || *kind == of_kind) return;
    reader.ErrorAt(key, std::string("'") + key + "' goes with 'kind " +
                            kScoreKindWords[static_cast<std::size_t>(of_kind)] + "' only: leave it out");
  };
  only("target", ScoreKind::kReach);
  only("within", ScoreKind::kReach);
  only("tilt", ScoreKind::kUpright);
  only("cell", ScoreKind::kCoverage);
  if (kind == ScoreKind::kReach) reader.Require("target", "target red");
  Take(reader.Word("target"), score.target);
  Take(reader.Number("within", Quantity::kLength, kMinFileSize_m, kMaxFileLength_m), score.within_m);
  Take(reader.Number("tilt", Quantity::kAngle, 0, kMaxTilt_rad), score.tilt_rad);
  Take(reader.Number("cell", Quantity::kLength, 0.01, 100), score.cell_m);
  score.until = ReadUntil(reader, score.kind);
  score.limit_s = reader.Number("limit", Quantity::kTime, 0, kMaxDuration_s);
  if (score.limit_s && *score.limit_s <= 0) reader.ErrorAt("limit", "'limit' must be above 0 s");
  reader.Finish();
  return kind ? std::optional(std::move(score)) : std::nullopt;
}

void CheckScores(const Scenario& scenario, Diagnostics& diagnostics) {
  std::map<std::string, std::size_t> subjects;  // name to number of robots or things
  std::vector<std::string> names, places;
  const auto add = [&](const std::string& name, std::size_t count) {
    if (subjects.emplace(ToLower(name), count).second) names.push_back(name);
  };
  for (const SwarmEntry& swarm : scenario.swarms) {
    add(swarm.name, swarm.count);
    add(swarm.section, swarm.count);
  }
  for (const RobotEntry& robot : scenario.robots) add(robot.name, 1);
  for (const RobotEntry& robot : scenario.robots) {
    for (const FrameModel& link : robot.model->frames) add(robot.name + "/" + link.name, 1);
  }
  for (const WorldObject& object : scenario.objects) {
    add(object.name, 1);
    places.push_back(object.name);
  }
  for (const Target& target : scenario.targets) {
    places.push_back(target.color_name);
    places.push_back(target.color_name + "_target_" + std::to_string(target.id.value));
  }
  for (const PointLight& light : scenario.lights) places.push_back(light.name);
  std::set<std::string> taken;
  for (const ScoreEntry& score : scenario.scores) {
    if (!taken.insert(ToLower(score.name)).second) {
      diagnostics.Error(score.where, "two scores are called '" + score.name +
                                         "': give one another name, for example: name " + score.name + "2");
    }
    std::size_t count = score.of.empty() ? scenario.robots.size() : 0;
    std::set<std::string> robots;
    for (const std::string& name : score.of) {
      const std::string robot = ToLower(name.substr(0, name.find('/')));
      if (!robots.insert(robot).second) {
        diagnostics.Error(score.where,
                          "the score '" + score.name + "' names '" + robot + "' twice: leave one out");
      }
      const auto found = subjects.find(ToLower(name));
      if (found == subjects.end()) {
        diagnostics.Error(score.where, "the score '" + score.name + "' is of '" + name +
                                           "', which is not a robot, swarm or thing" +
                                           DidYouMean(name, names));
        continue;
      }
      count += found->second;
    }
    if (score.kind == ScoreKind::kFormation && (count < 2 || count > kMaxFormation)) {
      diagnostics.Error(score.where, "'kind formation' is of 2 to " + std::to_string(kMaxFormation) +
                                         " robots, not of " + std::to_string(count) +
                                         ": name them, for example: of robot1 robot2");
    }
    if (score.target.empty()) continue;
    const bool known = std::ranges::any_of(
        places, [&](const std::string& one) { return ToLower(one) == ToLower(score.target); });
    if (!known) {
      diagnostics.Error(score.where, "the score '" + score.name + "' goes to '" + score.target +
                                         "', which is no target, thing or light" +
                                         DidYouMean(score.target, places));
    }
  }
}

}  // namespace coopdyn
