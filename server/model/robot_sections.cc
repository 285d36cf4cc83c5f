// SPDX-License-Identifier: MIT
#include "server/model/robot_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "server/base/random.h"
#include "server/model/section_reader.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr const char* kTransporter = "transporter";  // type of the robots of a team2

// The bar of a team2.
constexpr double kOverhang_m = 0.15;  // beyond the centre of each support
constexpr double kMinBar_m = 0.8, kMaxBar_m = 10;
// Cross-sections that the pins of the support can hold.
constexpr double kMinSection_m = 0.03, kMaxBarWidth_m = 0.052, kMaxBarHeight_m = 0.2;
constexpr double kMaxBarMass_kg = 20;

/// Distance from leader to helper, m.
double TeamDistance(const WorldObject& bar) {
  return std::get<Box>(bar.shape).size_m.x() - 2 * kOverhang_m;
}

constexpr std::size_t kMaxName = 63;

/// Names of the global modules: /simulation and so on.
const std::array<std::string, 6> kReservedNames = {"simulation", "world",    "swarm",
                                                   "playback",   "recorder", "clock"};

bool IsLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// robot1 for [ROBOT_1].
std::string DefaultName(const std::string& word) {
  std::string name = word;
  std::erase(name, '_');
  return name;
}

std::string WithoutSlash(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

std::string WhyNoRobotName(const std::string& name) {
  bool good = !name.empty() && name.size() <= kMaxName && IsLetter(name.front());
  for (const char c : name) good = good && (IsLetter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-');
  if (!good) {
    return "a robot's name is a letter, then letters, digits, _ and -, at most 63; not '" + name + "'";
  }
  if (std::ranges::count(kReservedNames, ToLower(name)) == 0) return {};
  return "'" + name + "' is the name of a module of the simulator: give the robot another name";
}

}  // namespace

std::string WhyNoName(const std::string& name, NamedKind kind) {
  if (kind == NamedKind::kRobot) return WhyNoRobotName(name);
  Diagnostics diagnostics;
  const std::vector<Section> sections = ReadSections("[" + name + "]\n", "", diagnostics);
  if (diagnostics.has_errors() || sections.size() != 1 || sections.front().name != name) {
    return "a name has letters, digits, _ and -, at most 63; not '" + name + "'";
  }
  const std::string& word = sections.front().word;
  const bool is_light = IsNumbered(word, "light");
  if (kind == NamedKind::kLight) {
    return is_light ? "" : "a light is called LIGHT_ and a word, for example LIGHT_2; not '" + name + "'";
  }
  bool is_own = is_light;
  for (const char* own : {"world", "simulation", "target", "floor"}) is_own |= word == own;
  for (const char* own : {"robot", "swarm", "random"}) is_own |= IsNumbered(word, own);
  return is_own ? "[" + name + "] is a section of another kind: give the thing another name" : "";
}

std::shared_ptr<const RobotModel> RobotSections::ReadType(SectionReader& reader, bool& team) {
  reader.Require("type", "type single");
  const std::optional<std::string> word = reader.Text("type");
  if (!word) return nullptr;
  if (!IsModelPath(*word) && word->find_first_of(" \t") != std::string::npos) {
    reader.ErrorAt("type", "'type' takes one word, or the path of a model's file, not '" + *word + "'");
    return nullptr;
  }
  const std::string lower = ToLower(*word);
  team = lower == "team2";
  const std::string type = team ? kTransporter : lower == "single" ? "coopbot" : *word;
  if (broken_types_.contains(type)) return nullptr;
  std::shared_ptr<const RobotModel> model = library_.Get(type, reader.LineOf("type"), diagnostics_, beside_);
  // Errors inside a model's file are reported once, an unknown type at every line that names it.
  if (model == nullptr && library_.Has(type, beside_)) broken_types_[type] = true;
  if (model != nullptr) KeepSource(type, *model);
  return model;
}

void RobotSections::KeepSource(const std::string& type, const RobotModel& model) {
  for (const SourceText& source : scenario_.sources) {
    if (source.kind == "robot" && source.name == type) return;
  }
  scenario_.sources.push_back({"robot", type, model.file, model.text});
}

void RobotSections::ReadShared(SectionReader& reader, RobotEntry& entry) {
  entry.where = reader.where();
  Take(reader.ColorValue("color"), entry.color);
  Take(reader.Choice<Fidelity>("fidelity", kFidelityWords), entry.fidelity);
  entry.controller = ReadController(reader, kControllerKey, library_, beside_);
  if (!entry.controller.empty() && entry.model != nullptr && !entry.model->has_actuators()) {
    reader.ErrorAt("controller",
                   "a " + entry.model->type +
                       " has no actuator module that a controller could command: add one to its " +
                       "model, or leave the line out");
  }
  Take(reader.YesNo("sockets"), entry.sockets);
  entry.watchdog_s = ReadWatchdog(reader);
}

void RobotSections::ReadLosses(SectionReader& reader, RobotEntry& entry) {
  constexpr double kMinDeadline_s = 1e-3, kMaxDeadline_s = 1e6;
  entry.deadline_s = reader.Number("deadline", Quantity::kTime, kMinDeadline_s, kMaxDeadline_s);
  // All policies except wait.
  if (const auto policy = reader.Choice("on_deadline", std::span(kLossPolicyWords).subspan(1))) {
    entry.on_deadline = static_cast<LossPolicy>(*policy + 1);
  }
  if (reader.Has("on_deadline") && !reader.Has("deadline")) {
    reader.WarningAt("on_deadline",
                     "'on_deadline' has no effect without 'deadline', for example: deadline 2s");
  }
  Take(reader.Choice<LossPolicy>("on_disconnect", kLossPolicyWords), entry.on_disconnect);
  if (entry.watchdog_s.value_or(0) > 0 && entry.runs_without_client()) {
    reader.WarningAt("watchdog", std::string("'watchdog' has no effect with 'on_disconnect ") +
                                     ToString(*entry.on_disconnect) +
                                     "', with which the robot continues alone");
  }
}

void RobotSections::ReadWaitsFor(SectionReader& reader, RobotEntry& entry) {
  const std::optional<std::string> list = reader.Text("waits_for");
  if (!list || entry.model == nullptr) return;
  const std::vector<std::string> known = entry.model->actuator_modules();
  if (known.empty()) {
    reader.ErrorAt("waits_for", "a " + entry.model->type + " has no actuator module, so nothing waits for " +
                                    "it: leave the line out");
    return;
  }
  std::string spaced = *list;
  std::replace(spaced.begin(), spaced.end(), ',', ' ');
  for (const std::string& word : SplitWords(spaced)) {
    const std::string name = ToLower(word);
    std::vector<std::string>& named = entry.waits_for;
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      reader.ErrorAt("waits_for", "'" + word + "' is no actuator module of " + entry.model->type +
                                      ": it has " + JoinNames(known) + "; write 'waits_for " + known.front() +
                                      "', or 'sync no' if lockstep is not to wait for this robot");
    } else if (std::find(named.begin(), named.end(), name) != named.end()) {
      reader.ErrorAt("waits_for", "'" + word + "' is named twice: name each module once");
    } else {
      named.push_back(name);
    }
  }
}

void RobotSections::CheckDriver(SectionReader& reader, const RobotEntry& entry) {
  if (entry.controller.empty()) return;
  const auto contradicts = [&reader](const std::string& key) {
    reader.ErrorAt(key, "'" + key + "' contradicts 'controller': a robot that the daemon drives itself is " +
                            "not waited for; keep one of the two lines");
  };
  if (reader.Has("sync") && entry.sync) contradicts("sync");
  if (reader.Has("waits_for")) contradicts("waits_for");
  for (const char* key : {"deadline", "on_disconnect", "watchdog"}) {
    if (!reader.Has(key)) continue;
    reader.WarningAt(key, std::string("'") + key + "' has no effect as long as the controller drives '" +
                              entry.name + "'");
  }
}

std::optional<WorldObject> RobotSections::ReadRobot(SectionReader& reader) {
  RobotEntry entry;
  bool team = false;
  entry.model = ReadType(reader, team);
  entry.name = DefaultName(reader.section().word);
  if (const auto name = reader.Word("name")) entry.name = WithoutSlash(*name);
  reader.Require("position", "position 0 0");
  const auto position = reader.Numbers("position", Quantity::kLength, {2, 3}, "x y, or x y z",
                                       -kMaxFileLength_m, kMaxFileLength_m);
  if (position) {
    entry.X_WR.p = Vector3((*position)[0], (*position)[1], position->size() == 3 ? (*position)[2] : 0);
    if (entry.X_WR.p.z() < 0) {
      reader.ErrorAt("position",
                     "the robot would stand below the floor: `position` is where its origin stands, so write "
                     "z = 0");
    }
  }
  Take(reader.Orientation("orientation"), entry.X_WR.q);
  ReadShared(reader, entry);
  ReadLosses(reader, entry);
  Take(reader.YesNo("sync"), entry.sync);
  ReadWaitsFor(reader, entry);
  CheckDriver(reader, entry);
  std::optional<WorldObject> bar;
  if (team) bar = ReadBar(reader, entry);
  reader.Finish();
  if (!team) {
    Add(std::move(entry), reader.LineOf("name"));
    return std::nullopt;
  }
  RobotEntry helper = entry;
  helper.name += "_helper";
  entry.name += "_leader";
  if (bar) helper.X_WR.p = entry.X_WR * Vector3(-TeamDistance(*bar), 0, 0);
  Add(std::move(entry), reader.LineOf("name"));
  Add(std::move(helper), reader.LineOf("name"));
  return bar;
}

std::optional<WorldObject> RobotSections::ReadBar(SectionReader& reader, const RobotEntry& leader) {
  WorldObject bar;
  bar.name = leader.name + "_bar";
  bar.where = reader.where();
  bar.color = {0.72, 0.53, 0.3};
  bar.mass_kg = 1;
  Vector3 size_m(1.5, 0.05, 0.05);
  if (const auto size = reader.Numbers("bar", Quantity::kLength, {3}, "length width height of the bar",
                                       kMinFileSize_m, kMaxFileLength_m)) {
    size_m = Vector3((*size)[0], (*size)[1], (*size)[2]);
    const auto check = [&](double value, double min, double max, const std::string& what) {
      constexpr double kTiny_m = 1e-9;  // 52mm is a little more than 0.052
      if (value >= min - kTiny_m && value <= max + kTiny_m) return;
      reader.ErrorAt("bar", "the " + what + " of the bar must lie between " + FormatNumber(min) + " and " +
                                FormatNumber(max) + " m, so that it lies on both supports; not " +
                                FormatNumber(value) + " m; for example: bar 1.5 0.05 0.05");
    };
    check(size_m.x(), kMinBar_m, kMaxBar_m, "length");
    check(size_m.y(), kMinSection_m, kMaxBarWidth_m, "width");
    check(size_m.z(), kMinSection_m, kMaxBarHeight_m, "height");
  }
  Take(reader.Number("bar_mass", Quantity::kMass, kMinFileMass_kg, kMaxBarMass_kg), bar.mass_kg);
  Take(reader.ColorValue("bar_color"), bar.color);
  if (leader.model == nullptr) return std::nullopt;
  const auto* support = leader.model->Find<SupportModel>();
  if (support == nullptr) {
    reader.ErrorAt("type", "a " + leader.model->type + " has no support, so it cannot carry a bar");
    return std::nullopt;
  }
  bar.shape = Box{size_m};
  bar.X_WO = leader.X_WR * Pose{Vector3(-TeamDistance(bar) / 2, 0, support->height_m + size_m.z() / 2),
                                Quaternion::Identity()};
  return bar;
}

void RobotSections::Add(RobotEntry entry, const SourceLine& where) {
  if (std::string why = WhyNoRobotName(entry.name); !why.empty()) {
    diagnostics_.Error(where, std::move(why));
  } else if (const auto [first, is_new] = names_.emplace(ToLower(entry.name), where); !is_new) {
    const int line = first->second.line;
    diagnostics_.Error(where,
                       line == 0 ? "there is a robot '" + entry.name + "' already: give this one another name"
                                 : "there are two robots '" + entry.name + "' (the first in line " +
                                       std::to_string(line) + "): give one another name");
  } else if (const auto swarm = swarm_names_.find(first->first); swarm != swarm_names_.end()) {
    diagnostics_.Error(where, "a swarm is called '" + entry.name + "' too (in line " +
                                  std::to_string(swarm->second.line) + "): give one another name");
  }
  const Vector3& p = entry.X_WR.p;
  if (!scenario_.floor.IsUnder(p.x(), p.y())) {
    diagnostics_.Warning(where, "'" + entry.name + "' stands beside the floor, which is " +
                                    FormatNumber(scenario_.floor.length_m) + " x " +
                                    FormatNumber(scenario_.floor.width_m) + " m about the origin");
  }
  scenario_.robots.push_back(std::move(entry));
}

bool RobotSections::TakeSwarmName(const std::string& name, const SourceLine& where,
                                  const std::string& remedy) {
  const std::string lower = ToLower(name);
  const auto robot = names_.find(lower);
  const auto [swarm, is_new] = swarm_names_.emplace(lower, where);
  const bool is_robots = robot != names_.end();
  if (is_new && !is_robots) return true;
  const int line = is_robots ? robot->second.line : swarm->second.line;
  diagnostics_.Error(where, (is_robots ? "a robot" : "another swarm") + (" is called '" + name) +
                                "' too (in line " + std::to_string(line) + "): " + remedy);
  return false;
}

void RobotSections::ReadSwarm(SectionReader& reader) {
  RobotEntry entry;
  bool team = false;
  entry.sockets = false;
  entry.model = ReadType(reader, team);
  if (team) reader.ErrorAt("type", "a swarm consists of single robots: write 'type single'");
  reader.Require("count", "count 20");
  entry.name = DefaultName(reader.section().word);
  const auto count = reader.WholeNumber("count", 1, kMaxSwarm);
  if (const auto name = reader.Word("name")) entry.name = WithoutSlash(*name);
  ReadShared(reader, entry);
  const auto spacing = reader.Number("spacing", Quantity::kLength, 0, kMaxFileLength_m);
  const std::optional<FloorArea> area = ReadArea(reader);
  const auto seed = reader.WholeNumber("seed", 0, kMaxSeed);
  reader.Finish();
  if (entry.model == nullptr || team || !count || (reader.Has("area") && !area)) return;

  wanted_ += *count;
  if (wanted_ > kMaxSwarms) {
    reader.ErrorAt("count", "all swarms together have more than " + std::to_string(kMaxSwarms) +
                                " robots: take smaller counts");
    return;
  }

  SwarmRequest request;
  request.count = static_cast<int>(*count);
  request.radius_m = entry.model->footprint_radius_m;
  request.height_m = entry.model->height_m;
  request.spacing_m = spacing.value_or(2.5 * request.radius_m);
  request.area = area.value_or(FloorArea{0, 0, scenario_.floor.length_m, scenario_.floor.width_m});
  // A different draw for each swarm; otherwise all would have the same places.
  request.seed = seed.value_or(scenario_.simulation.seed + kGolden * scenario_.swarms.size());
  if (request.spacing_m < 2 * request.radius_m) {
    reader.ErrorAt("spacing", "'spacing' is the distance between the robots' centres: at least " +
                                  FormatNumber(2 * request.radius_m) + " m, the diameter of a " +
                                  entry.model->type);
    return;
  }
  const std::vector<FloorPlace> places = PlaceSwarm(request, scenario_.objects, TakenPlaces());
  if (places.size() < *count) {
    reader.ErrorAt("count", DoNotFit(request, places.size(), "robots"));
    return;
  }
  const std::string name = entry.name;
  const std::string section = DefaultName(reader.section().word);
  scenario_.swarms.push_back({name, section, 0, static_cast<std::size_t>(*count), reader.where()});
  if (!TakeSwarmName(name, reader.LineOf("name"), "give the swarm another name")) return;
  if (section != ToLower(name) &&
      !TakeSwarmName(section, reader.where(),
                     "this section always has this name, give the other another name")) {
    return;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    entry.name = name + "_" + std::to_string(i + 1);
    entry.X_WR = {Vector3(places[i].x_m, places[i].y_m, 0), FromRollPitchYaw(0, 0, places[i].heading_rad)};
    Add(entry, reader.LineOf("name"));
    if (!WhyNoRobotName(entry.name).empty()) return;  // report it once
  }
}

std::vector<FloorPlace> RobotSections::TakenPlaces() const {
  std::vector<FloorPlace> taken;
  for (const RobotEntry& robot : scenario_.robots) {
    if (robot.model == nullptr) continue;
    taken.push_back({robot.X_WR.p.x(), robot.X_WR.p.y(), 0, robot.model->footprint_radius_m});
  }
  return taken;
}

void RobotSections::SortAsInFile() {
  std::stable_sort(scenario_.robots.begin(), scenario_.robots.end(),
                   [](const RobotEntry& a, const RobotEntry& b) { return a.where.line < b.where.line; });
  for (std::size_t i = 0; i < scenario_.robots.size(); ++i) {
    scenario_.robots[i].id = RobotId{static_cast<std::uint32_t>(i + 1)};
  }
  for (SwarmEntry& swarm : scenario_.swarms) {
    const auto first =
        std::lower_bound(scenario_.robots.begin(), scenario_.robots.end(), swarm.where.line,
                         [](const RobotEntry& robot, int line) { return robot.where.line < line; });
    swarm.first = static_cast<std::size_t>(first - scenario_.robots.begin());
  }
}

}  // namespace coopdyn
