// SPDX-License-Identifier: MIT
#include "server/record/run_tables.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "server/record/state_codec.h"

namespace coopdyn {

namespace {

constexpr const char* kSchema = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE text(kind TEXT, name TEXT, file TEXT, content TEXT, PRIMARY KEY(kind, name)) WITHOUT ROWID;
CREATE TABLE scene(id INTEGER PRIMARY KEY, first_step INTEGER, description BLOB, chain INTEGER);
CREATE TABLE body(scene INTEGER, place INTEGER, id INTEGER, name TEXT, robot INTEGER,
                  PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE robot(scene INTEGER, place INTEGER, id INTEGER, name TEXT, type TEXT, body INTEGER,
                   p_x REAL, p_y REAL, p_z REAL, q_w REAL, q_x REAL, q_y REAL, q_z REAL, sensors INTEGER,
                   PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE channel(scene INTEGER, place INTEGER, robot INTEGER, module TEXT, joint TEXT,
                     PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE target(scene INTEGER, place INTEGER, id INTEGER, color TEXT, x REAL, y REAL, z REAL,
                    PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE step(step INTEGER PRIMARY KEY, time_ns INTEGER, hash INTEGER, scene INTEGER, commands BLOB,
                  messages BLOB, channels BLOB, distances BLOB, targets BLOB, poses BLOB, scores BLOB,
                  chain INTEGER);
CREATE TABLE image(step INTEGER, robot TEXT, module TEXT, width INTEGER, height INTEGER, jpeg BLOB,
                   PRIMARY KEY(step, robot, module));
CREATE TABLE keyframe(step INTEGER PRIMARY KEY, state BLOB, chain INTEGER);
CREATE TABLE input(id INTEGER PRIMARY KEY, step INTEGER, action TEXT, detail TEXT, chain INTEGER);
CREATE TABLE event(id INTEGER PRIMARY KEY, step INTEGER, time_ns INTEGER, level TEXT, text TEXT, chain INTEGER);
)";

const JointModel& JointOf(const Scene& scene, std::size_t channel) {
  const Channel& of = scene.channels[channel];
  const RobotModel& model = *scene.robots[static_cast<std::size_t>(of.robot)].entry.model;
  return model.joints[static_cast<std::size_t>(of.joint)];
}

/// The unit of the joint's position.
const char* UnitOf(const JointModel& joint) {
  return joint.muscle || joint.kind == JointModel::Kind::kForce ? "m" : "rad";
}

using Meta = std::unordered_map<std::string, std::string>;

/// Nullopt if `key` is missing or no number.
template <typename Number>
std::optional<Number> NumberOf(Meta& meta, const std::string& key) {
  const std::string& text = meta[key];
  Number number{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// The text fields of a header by key.
constexpr std::array<std::pair<const char*, std::string RunHeader::*>, 8> kTexts{
    {{"version", &RunHeader::version},
     {"build", &RunHeader::build},
     {"cpu", &RunHeader::cpu},
     {"started", &RunHeader::started},
     {"command", &RunHeader::command},
     {"scenario_name", &RunHeader::scenario_name},
     {"scenario_file", &RunHeader::scenario_file},
     {"scores", &RunHeader::scores}}};

/// "diffuse 0123456789abcdef, flock …".
std::string PluginsText(const std::vector<PluginHash>& plugins) {
  std::string text;
  for (const PluginHash& one : plugins) text += (text.empty() ? "" : ", ") + one.name + " " + one.hash;
  return text;
}

std::vector<PluginHash> PluginsIn(const std::string& text) {
  std::vector<PluginHash> plugins;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find(", ", start), text.size());
    const std::string one = text.substr(start, end - start);
    const std::size_t space = one.rfind(' ');
    if (space != std::string::npos) plugins.push_back({one.substr(0, space), one.substr(space + 1)});
    start = end + 2;
  }
  return plugins;
}

void WriteBodies(const Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO body VALUES(?, ?, ?, ?, ?)");
  const std::vector<std::string> names = BodyNames(scene);
  std::vector<std::optional<std::size_t>> robots(names.size());
  for (std::size_t place = 0; place < scene.robots.size(); ++place) {
    const SceneRobot& robot = scene.robots[place];
    std::fill_n(robots.begin() + robot.first_body, robot.body_count, place);
  }
  for (std::size_t place = 0; place < names.size(); ++place) {
    insert.Run(number, place, scene.body_ids[place].value, names[place], robots[place]);
  }
}

void WriteRobots(const Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO robot VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t place = 0; place < scene.robots.size(); ++place) {
    const SceneRobot& robot = scene.robots[place];
    const Vector3& p = robot.X_BR.p;
    const Quaternion& q = robot.X_BR.q;
    insert.Run(number, place, robot.id.value, robot.entry.name, robot.entry.model->type, robot.first_body,
               p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), robot.entry.model->sector_count());
  }
}

void WriteChannels(const Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO channel VALUES(?, ?, ?, ?, ?)");
  for (const SceneActuator& actuator : scene.actuators) {
    for (int place = actuator.first_channel; place < actuator.first_channel + actuator.channel_count;
         ++place) {
      insert.Run(number, place, actuator.robot, actuator.module,
                 JointOf(scene, static_cast<std::size_t>(place)).name);
    }
  }
}

void WriteTargets(const Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO target VALUES(?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t place = 0; place < scene.targets.size(); ++place) {
    const Target& target = scene.targets[place];
    const Vector3& p = target.p_WT;
    insert.Run(number, place, target.id.value, target.color_name, p.x(), p.y(), p.z());
  }
}

}  // namespace

void CreateTables(Database& database) {
  database.Run(kSchema);
}

void WriteHeader(const Database& database, const RunHeader& header) {
  for (const auto& [key, text] : kTexts) SetMeta(database, key, header.*text);
  SetMeta(database, "scenario_seed", std::to_string(header.scenario_seed));
  SetMeta(database, "seed", std::to_string(header.seed));
  SetMeta(database, "mode", std::string_view(ToString(header.mode)));
  SetMeta(database, "what", ToString(header.what));
  if (!header.controllers.empty()) SetMeta(database, "controllers", PluginsText(header.controllers));
  if (!header.libraries.empty()) SetMeta(database, "libraries", PluginsText(header.libraries));
  if (header.substeps) SetMeta(database, "substeps", *header.substeps);
  SetMeta(database, "step_ns", header.step_length);
  SetMeta(database, "pose_every_ns", header.pose_every);
  SetMeta(database, "closed", 0);
  SetMeta(database, "lost", 0);
  Statement insert = database.Prepare("INSERT OR REPLACE INTO text VALUES(?, ?, ?, ?)");
  insert.Run("scenario", header.scenario_name, header.scenario_file, header.scenario_text);
  for (const SourceText& source : header.sources) {
    insert.Run(source.kind, source.name, source.file, source.text);
  }
}

std::string ReadHeader(const Database& database, RunHeader& header) {
  Meta meta;
  Statement rows = database.Prepare("SELECT key, value FROM meta");
  while (rows.Step()) meta.insert_or_assign(rows.text(0), rows.text(1));
  Statement texts = database.Prepare("SELECT kind, name, file, content FROM text ORDER BY kind, name");
  while (texts.Step()) {
    if (texts.text(0) == "scenario") {
      header.scenario_text = texts.text(3);
    } else {
      header.sources.push_back({texts.text(0), texts.text(1), texts.text(2), texts.text(3)});
    }
  }
  for (const auto& [key, text] : kTexts) header.*text = meta[key];
  header.substeps = NumberOf<int>(meta, "substeps");
  header.controllers = PluginsIn(meta["controllers"]);
  header.libraries = PluginsIn(meta["libraries"]);
  std::string wrong;
  const auto take = [&wrong](const char* key, const auto& read, bool fits, auto& value) {
    if (read && fits) {
      value = *read;
    } else if (wrong.empty()) {
      wrong = key;
    }
  };
  std::string unknown;
  const auto step = NumberOf<Nanoseconds>(meta, "step_ns");
  const auto pose_every = NumberOf<Nanoseconds>(meta, "pose_every_ns");
  take("mode", ParseMode(meta["mode"]), true, header.mode);
  take("seed", NumberOf<std::uint64_t>(meta, "seed"), true, header.seed);
  take("scenario_seed", NumberOf<std::uint64_t>(meta, "scenario_seed"), true, header.scenario_seed);
  take("step_ns", step, step >= kMinStep && step <= kMaxStep, header.step_length);
  take("pose_every_ns", pose_every, pose_every >= 0, header.pose_every);
  take("what", ParseRecordWhat(meta["what"], unknown), true, header.what);
  if (wrong.empty()) return {};
  return database.file() + " is damaged: its table meta says '" + meta[wrong] + "' for " + wrong +
         ": copy it again from where it was recorded";
}

void WriteScene(const Database& database, std::int64_t number, std::uint64_t first_step, const Scene& scene) {
  database.Prepare("INSERT INTO scene(id, first_step, description) VALUES(?, ?, ?)")
      .Run(number, first_step, EncodeScene(scene));
  WriteBodies(database, number, scene);
  WriteRobots(database, number, scene);
  WriteChannels(database, number, scene);
  WriteTargets(database, number, scene);
}

const std::string& ChannelName(const Scene& scene, std::size_t channel) {
  return JointOf(scene, channel).name;
}

std::string ChannelUnit(const Scene& scene, std::size_t channel) {
  return UnitOf(JointOf(scene, channel));
}

std::string SetpointUnit(const std::string& unit, ControlMode mode) {
  switch (mode) {
    case ControlMode::kVelocity:
      return unit + "_s";
    case ControlMode::kEffort:
      return unit == "m" ? "n" : "nm";
    case ControlMode::kPwm:
      return "duty";
    default:
      return unit;
  }
}

std::vector<std::string> BodyNames(const Scene& scene) {
  std::vector<std::string> names(scene.body_ids.size());
  for (const SceneObject& object : scene.objects) {
    if (object.body >= 0) names[static_cast<std::size_t>(object.body)] = object.object.name;
  }
  for (const SceneRobot& robot : scene.robots) {
    const auto first = static_cast<std::size_t>(robot.first_body);
    if (robot.one_body()) {
      names[first] = robot.entry.name;
      continue;
    }
    for (std::size_t link = 0; link < static_cast<std::size_t>(robot.body_count); ++link) {
      names[first + link] = robot.entry.name + "." + robot.entry.model->links[link].name;
    }
  }
  return names;
}

}  // namespace coopdyn
