// SPDX-License-Identifier: MIT
#include "server/record/run_tables.h"

#include <algorithm>
#include <vector>

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
CREATE TABLE target(scene INTEGER, place INTEGER, id INTEGER, color TEXT, x REAL, y REAL, z REAL,
                    PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE step(step INTEGER PRIMARY KEY, time_ns INTEGER, hash INTEGER, scene INTEGER, commands BLOB,
                  messages BLOB, wheels BLOB, distances BLOB, targets BLOB, poses BLOB, chain INTEGER);
CREATE TABLE keyframe(step INTEGER PRIMARY KEY, state BLOB, chain INTEGER);
CREATE TABLE input(id INTEGER PRIMARY KEY, step INTEGER, action TEXT, detail TEXT, chain INTEGER);
CREATE TABLE event(id INTEGER PRIMARY KEY, step INTEGER, time_ns INTEGER, level TEXT, text TEXT, chain INTEGER);
)";

constexpr const char* kInsertMeta = "INSERT OR REPLACE INTO meta VALUES(?, ?)";

bool WriteText(Database& database, const SourceText& text) {
  Statement insert = database.Prepare("INSERT OR REPLACE INTO text VALUES(?, ?, ?, ?)");
  if (!insert) return false;
  insert.BindText(1, text.kind);
  insert.BindText(2, text.name);
  insert.BindText(3, text.file);
  insert.BindText(4, text.text);
  return insert.Run();
}

/// The place of the robot that each body belongs to; −1: an object.
std::vector<int> RobotsOfBodies(const Scene& scene) {
  std::vector<int> robots(scene.body_ids.size(), -1);
  for (std::size_t place = 0; place < scene.robots.size(); ++place) {
    const SceneRobot& robot = scene.robots[place];
    std::fill_n(robots.begin() + robot.first_body, robot.body_count, static_cast<int>(place));
  }
  return robots;
}

bool WriteBodies(Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO body VALUES(?, ?, ?, ?, ?)");
  if (!insert) return false;
  const std::vector<std::string> names = BodyNames(scene);
  const std::vector<int> robots = RobotsOfBodies(scene);
  insert.Bind(1, number);
  for (std::size_t place = 0; place < names.size(); ++place) {
    insert.Bind(2, static_cast<std::int64_t>(place));
    insert.Bind(3, std::int64_t{scene.body_ids[place].value});
    insert.BindText(4, names[place]);
    if (robots[place] < 0) {
      insert.BindNull(5);
    } else {
      insert.Bind(5, std::int64_t{robots[place]});
    }
    if (!insert.Run()) return false;
  }
  return true;
}

bool WriteRobots(Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO robot VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  if (!insert) return false;
  insert.Bind(1, number);
  for (std::size_t place = 0; place < scene.robots.size(); ++place) {
    const SceneRobot& robot = scene.robots[place];
    insert.Bind(2, static_cast<std::int64_t>(place));
    insert.Bind(3, std::int64_t{robot.id.value});
    insert.BindText(4, robot.entry.name);
    insert.BindText(5, robot.entry.model->type);
    insert.Bind(6, std::int64_t{robot.first_body});
    int column = 7;
    for (const double p_m : robot.X_BR.p) insert.Bind(column++, p_m);
    const Quaternion& q = robot.X_BR.q;
    for (const double component : {q.w(), q.x(), q.y(), q.z()}) insert.Bind(column++, component);
    insert.Bind(column, static_cast<std::int64_t>(robot.entry.model->sector_count()));
    if (!insert.Run()) return false;
  }
  return true;
}

bool WriteTargets(Database& database, std::int64_t number, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO target VALUES(?, ?, ?, ?, ?, ?, ?)");
  if (!insert) return false;
  insert.Bind(1, number);
  for (std::size_t place = 0; place < scene.targets.size(); ++place) {
    const Target& target = scene.targets[place];
    insert.Bind(2, static_cast<std::int64_t>(place));
    insert.Bind(3, std::int64_t{target.id.value});
    insert.BindText(4, target.color_name);
    for (int axis = 0; axis < 3; ++axis) insert.Bind(5 + axis, target.p_WT[axis]);
    if (!insert.Run()) return false;
  }
  return true;
}

}  // namespace

bool CreateTables(Database& database) {
  return database.Run(kSchema);
}

bool WriteHeader(Database& database, const RunHeader& header) {
  const std::pair<const char*, std::string> texts[] = {
      {"version", header.version},
      {"build", header.build},
      {"cpu", header.cpu},
      {"started", header.started},
      {"command", header.command},
      {"scenario_name", header.scenario_name},
      {"scenario_file", header.scenario_file},
      {"scenario_seed", std::to_string(header.scenario_seed)},
      {"seed", std::to_string(header.seed)},
      {"mode", ToString(header.mode)},
      {"what", ToString(header.what)},
  };
  for (const auto& [key, value] : texts) {
    if (!SetMetaText(database, key, value)) return false;
  }
  std::string controllers;
  for (const PluginHash& one : header.controllers) {
    controllers += (controllers.empty() ? "" : ", ") + one.name + " " + one.hash;
  }
  if (!controllers.empty() && !SetMetaText(database, "controllers", controllers)) return false;
  if (header.substeps && !SetMeta(database, "substeps", *header.substeps)) return false;
  if (!SetMeta(database, "format", kRunFormat) || !SetMeta(database, "step_ns", header.step_length) ||
      !SetMeta(database, "pose_every_ns", header.pose_every) || !SetMeta(database, "closed", 0) ||
      !SetMeta(database, "lost", 0)) {
    return false;
  }
  if (!WriteText(database, {"scenario", header.scenario_name, header.scenario_file, header.scenario_text})) {
    return false;
  }
  for (const SourceText& source : header.sources) {
    if (!WriteText(database, source)) return false;
  }
  return true;
}

bool WriteScene(Database& database, std::int64_t number, std::uint64_t first_step, const Scene& scene) {
  Statement insert = database.Prepare("INSERT INTO scene(id, first_step, description) VALUES(?, ?, ?)");
  if (!insert) return false;
  const std::vector<std::byte> description = EncodeScene(scene);
  insert.Bind(1, number);
  insert.Bind(2, static_cast<std::int64_t>(first_step));
  insert.BindBlob(3, description);
  return insert.Run() && WriteBodies(database, number, scene) && WriteRobots(database, number, scene) &&
         WriteTargets(database, number, scene);
}

bool SetMeta(Database& database, const std::string& key, std::int64_t value) {
  Statement insert = database.Prepare(kInsertMeta);
  if (!insert) return false;
  insert.BindText(1, key);
  insert.Bind(2, value);
  return insert.Run();
}

bool SetMetaText(Database& database, const std::string& key, const std::string& value) {
  Statement insert = database.Prepare(kInsertMeta);
  if (!insert) return false;
  insert.BindText(1, key);
  insert.BindText(2, value);
  return insert.Run();
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
