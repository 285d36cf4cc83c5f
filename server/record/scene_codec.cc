// SPDX-License-Identifier: MIT
// EncodeScene() and DecodeScene() of state_codec.h.
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

#include "server/record/bytes.h"
#include "server/record/state_codec.h"

namespace coopdyn {

namespace {

constexpr std::uint8_t kSceneVersion = 2;
constexpr std::uint8_t kNothing = 255;  // instead of an optional word
// Least bytes of each, so that a count cannot ask for more memory than there are bytes.
constexpr std::size_t kObjectBytes = 100, kRobotBytes = 146, kTargetBytes = 60;

// --- parts
// ---------------------------------------------------------------------------------------------------

void PutPose(const Pose& X, ByteWriter& writer) {
  writer.PutAll(X.p);
  writer.PutAll(X.q.coeffs());  // x y z w
}

void PutColor(const Color& color, ByteWriter& writer) {
  writer.Put(color.r);
  writer.Put(color.g);
  writer.Put(color.b);
}

void PutWhere(const SourceLine& where, ByteWriter& writer) {
  writer.PutText(where.file);
  writer.Put(static_cast<std::int32_t>(where.line));
}

void PutBool(bool value, ByteWriter& writer) {
  writer.Put(static_cast<std::uint8_t>(value ? 1 : 0));
}

double GetFinite(ByteReader& reader) {
  const auto number = reader.Get<double>();
  if (!std::isfinite(number)) reader.Fail();
  return number;
}

double GetAtLeast(double least, ByteReader& reader) {
  const double number = GetFinite(reader);
  if (number < least) reader.Fail();
  return number;
}

/// A length that a thing can have.
double GetSize(ByteReader& reader) {
  const double size_m = GetFinite(reader);
  if (size_m <= 0) reader.Fail();
  return size_m;
}

Vector3 GetVector(ByteReader& reader) {
  Vector3 v;
  for (double& number : v) number = GetFinite(reader);
  return v;
}

Pose GetPose(ByteReader& reader) {
  Pose X;
  X.p = GetVector(reader);
  for (double& number : X.q.coeffs()) number = GetFinite(reader);
  if (std::abs(X.q.norm() - 1) > 1e-6) reader.Fail();
  return X;
}

Color GetColor(ByteReader& reader) {
  Color color;
  color.r = GetFinite(reader);
  color.g = GetFinite(reader);
  color.b = GetFinite(reader);
  return color;
}

SourceLine GetWhere(ByteReader& reader) {
  SourceLine where;
  where.file = reader.GetText();
  where.line = reader.Get<std::int32_t>();
  return where;
}

bool GetBool(ByteReader& reader) {
  const auto value = reader.Get<std::uint8_t>();
  if (value > 1) reader.Fail();
  return value != 0;
}

/// A word of an enum whose last one is `last`.
template <typename Word>
Word GetWord(ByteReader& reader, Word last) {
  const auto value = reader.Get<std::uint8_t>();
  if (value > static_cast<std::uint8_t>(last)) reader.Fail();
  return reader.ok() ? static_cast<Word>(value) : last;
}

// --- shapes
// --------------------------------------------------------------------------------------------------

void PutShape(const Shape& shape, ByteWriter& writer) {
  writer.Put(static_cast<std::uint8_t>(shape.index()));
  std::visit(
      [&writer](const auto& s) {
        using Kind = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<Kind, Box>) {
          writer.PutAll(s.size_m);
        } else {
          writer.Put(s.radius_m);
          if constexpr (std::is_same_v<Kind, Cylinder>) writer.Put(s.length_m);
        }
      },
      shape);
}

Shape GetShape(ByteReader& reader) {
  switch (reader.Get<std::uint8_t>()) {
    case 0: {
      Box box;
      for (double& size_m : box.size_m) size_m = GetSize(reader);
      return box;
    }
    case 1: {
      Cylinder cylinder;
      cylinder.radius_m = GetSize(reader);
      cylinder.length_m = GetSize(reader);
      return cylinder;
    }
    case 2:
      return Sphere{GetSize(reader)};
    default:
      reader.Fail();
      return Sphere{1};
  }
}

// --- things
// --------------------------------------------------------------------------------------------------

void PutFloor(const Floor& floor, ByteWriter& writer) {
  writer.Put(floor.length_m);
  writer.Put(floor.width_m);
  writer.Put(floor.height_m);
  PutColor(floor.color, writer);
  writer.Put(floor.friction);
  PutWhere(floor.where, writer);
}

Floor GetFloor(ByteReader& reader) {
  Floor floor;
  floor.length_m = GetSize(reader);
  floor.width_m = GetSize(reader);
  floor.height_m = GetAtLeast(0, reader);
  floor.color = GetColor(reader);
  floor.friction = GetAtLeast(0, reader);
  floor.where = GetWhere(reader);
  return floor;
}

void PutObject(const SceneObject& thing, ByteWriter& writer) {
  const WorldObject& object = thing.object;
  writer.Put(thing.id.value);
  writer.Put(static_cast<std::int32_t>(thing.body));
  writer.PutText(object.name);
  PutShape(object.shape, writer);
  PutPose(object.X_WO, writer);
  writer.Put(object.mass_kg);
  PutColor(object.color, writer);
  writer.Put(object.friction);
  PutWhere(object.where, writer);
}

SceneObject GetObject(ByteReader& reader) {
  SceneObject thing;
  thing.id.value = reader.Get<std::uint32_t>();
  thing.body = reader.Get<std::int32_t>();
  thing.object.name = reader.GetText();
  thing.object.shape = GetShape(reader);
  thing.object.X_WO = GetPose(reader);
  thing.object.mass_kg = GetFinite(reader);
  thing.object.color = GetColor(reader);
  thing.object.friction = GetAtLeast(0, reader);
  thing.object.where = GetWhere(reader);
  return thing;
}

void PutTarget(const Target& target, ByteWriter& writer) {
  writer.Put(target.id.value);
  writer.PutText(target.color_name);
  PutColor(target.color, writer);
  writer.PutAll(target.p_WT);
  PutWhere(target.where, writer);
}

Target GetTarget(ByteReader& reader) {
  Target target;
  target.id.value = reader.Get<std::uint32_t>();
  target.color_name = reader.GetText();
  target.color = GetColor(reader);
  target.p_WT = GetVector(reader);
  target.where = GetWhere(reader);
  return target;
}

// --- robots
// --------------------------------------------------------------------------------------------------

/// Without the file: a recording of unknown origin must not say what code is loaded.
void PutController(const ControllerChoice& controller, ByteWriter& writer) {
  writer.PutText(controller.name);
  writer.Put(static_cast<std::uint32_t>(controller.options.size()));
  for (const auto& [name, value] : controller.options) {
    writer.PutText(name);
    writer.Put(value);
  }
  PutWhere(controller.where, writer);
}

ControllerChoice GetController(ByteReader& reader, const Scenario& scenario) {
  ControllerChoice controller;
  controller.name = reader.GetText();
  const std::size_t options = reader.GetCount(4 + 8);
  for (std::size_t i = 0; reader.ok() && i < options; ++i) {
    std::string name = reader.GetText();
    const auto value = reader.Get<double>();
    controller.options.emplace_back(std::move(name), value);
  }
  controller.where = GetWhere(reader);
  if (controller.empty()) return controller;
  for (const RobotEntry& entry : scenario.robots) {
    if (entry.controller.name != controller.name) continue;
    controller.file = entry.controller.file;
    break;
  }
  return controller;
}

void PutEntry(const RobotEntry& entry, ByteWriter& writer) {
  writer.Put(entry.id.value);
  writer.PutText(entry.name);
  writer.PutText(entry.model->type);
  PutPose(entry.X_WR, writer);
  PutColor(entry.color, writer);
  PutBool(entry.sync, writer);
  writer.Put(static_cast<std::uint32_t>(entry.waits_for.size()));
  for (const std::string& module : entry.waits_for) writer.PutText(module);
  PutBool(entry.deadline_s.has_value(), writer);
  writer.Put(entry.deadline_s.value_or(0));
  writer.Put(static_cast<std::uint8_t>(entry.on_deadline));
  writer.Put(entry.on_disconnect ? static_cast<std::uint8_t>(*entry.on_disconnect) : kNothing);
  writer.Put(static_cast<std::uint8_t>(entry.fidelity));
  PutController(entry.controller, writer);
  PutBool(entry.sockets, writer);
  PutWhere(entry.where, writer);
}

using FindModel = std::function<std::shared_ptr<const RobotModel>(const std::string& type)>;

RobotEntry GetEntry(ByteReader& reader, const Scenario& scenario, const FindModel& model) {
  RobotEntry entry;
  entry.id.value = reader.Get<std::uint32_t>();
  entry.name = reader.GetText();
  const std::string type = reader.GetText();
  if (reader.ok()) entry.model = model(type);
  if (entry.model == nullptr || entry.model->links.empty()) reader.Fail();
  entry.X_WR = GetPose(reader);
  entry.color = GetColor(reader);
  entry.sync = GetBool(reader);
  const std::size_t modules = reader.GetCount(4);
  for (std::size_t i = 0; reader.ok() && i < modules; ++i) entry.waits_for.push_back(reader.GetText());
  const bool has_deadline = GetBool(reader);
  const double deadline_s = GetFinite(reader);
  if (has_deadline) entry.deadline_s = deadline_s;
  entry.on_deadline = GetWord(reader, LossPolicy::kDrop);
  const auto on_disconnect = reader.Get<std::uint8_t>();
  if (on_disconnect <= static_cast<std::uint8_t>(LossPolicy::kDrop)) {
    entry.on_disconnect = static_cast<LossPolicy>(on_disconnect);
  } else if (on_disconnect != kNothing) {
    reader.Fail();
  }
  entry.fidelity = GetWord(reader, Fidelity::kPlanar);
  entry.controller = GetController(reader, scenario);
  entry.sockets = GetBool(reader);
  entry.where = GetWhere(reader);
  return entry;
}

void PutRobot(const SceneRobot& robot, ByteWriter& writer) {
  writer.Put(robot.id.value);
  PutEntry(robot.entry, writer);
  writer.Put(static_cast<std::int32_t>(robot.first_body));
  writer.Put(static_cast<std::int32_t>(robot.body_count));
  PutPose(robot.X_BR, writer);
  PutBool(robot.axes_of_R, writer);
}

SceneRobot GetRobot(ByteReader& reader, const Scenario& scenario, const FindModel& model) {
  SceneRobot robot;
  robot.id.value = reader.Get<std::uint32_t>();
  robot.entry = GetEntry(reader, scenario, model);
  robot.first_body = reader.Get<std::int32_t>();
  robot.body_count = reader.Get<std::int32_t>();
  robot.X_BR = GetPose(reader);
  robot.axes_of_R = GetBool(reader);
  return robot;
}

/// Every dynamic body belongs to one thing, every index is inside, ids increase.
bool Fits(const Scene& scene) {
  std::vector<bool> taken(scene.body_ids.size());
  const auto take = [&taken](int body) {
    const auto place = static_cast<std::size_t>(body);
    if (body < 0 || place >= taken.size() || taken[place]) return false;
    taken[place] = true;
    return true;
  };
  std::uint32_t last = 0;
  const auto increases = [&last](std::uint32_t id) { return std::exchange(last, id) < id; };
  for (const SceneObject& thing : scene.objects) {
    const bool is_static = thing.object.is_static();
    if (!increases(thing.id.value) || (is_static ? thing.body != -1 : !take(thing.body))) return false;
  }
  last = 0;
  for (const SceneRobot& robot : scene.robots) {
    const std::size_t bodies = robot.one_body() ? 1 : robot.entry.model->links.size();
    if (!increases(robot.id.value)) return false;
    if (robot.body_count != static_cast<int>(bodies) || robot.first_body < 0) return false;
    if (static_cast<std::size_t>(robot.first_body) + bodies > taken.size()) return false;
    for (int body = 0; body < robot.body_count; ++body) {
      if (!take(robot.first_body + body)) return false;
    }
  }
  last = 0;
  for (const Target& target : scene.targets) {
    if (!increases(target.id.value)) return false;
  }
  last = 0;
  for (std::size_t body = 0; body < taken.size(); ++body) {
    if (!taken[body] || !increases(scene.body_ids[body].value)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::byte> EncodeScene(const Scene& scene) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  writer.Put(kSceneVersion);
  PutFloor(scene.floor, writer);
  writer.Put(static_cast<std::uint32_t>(scene.objects.size()));
  for (const SceneObject& object : scene.objects) PutObject(object, writer);
  writer.Put(static_cast<std::uint32_t>(scene.robots.size()));
  for (const SceneRobot& robot : scene.robots) PutRobot(robot, writer);
  writer.Put(static_cast<std::uint32_t>(scene.targets.size()));
  for (const Target& target : scene.targets) PutTarget(target, writer);
  writer.Put(static_cast<std::uint32_t>(scene.body_ids.size()));
  for (const BodyId body : scene.body_ids) writer.Put(body.value);
  return bytes;
}

std::shared_ptr<const Scene> DecodeScene(std::span<const std::byte> bytes,
                                         const std::shared_ptr<const Scenario>& scenario,
                                         const FindModel& model) {
  auto scene = std::make_shared<Scene>();
  ByteReader reader(bytes);
  if (reader.Get<std::uint8_t>() != kSceneVersion) return nullptr;
  scene->floor = GetFloor(reader);
  const std::size_t objects = reader.GetCount(kObjectBytes);
  for (std::size_t i = 0; reader.ok() && i < objects; ++i) scene->objects.push_back(GetObject(reader));
  const std::size_t robots = reader.GetCount(kRobotBytes);
  for (std::size_t i = 0; reader.ok() && i < robots; ++i) {
    SceneRobot robot = GetRobot(reader, *scenario, model);
    if (robot.entry.model == nullptr) return nullptr;
    AddRobot(*scene, std::move(robot));
  }
  const std::size_t targets = reader.GetCount(kTargetBytes);
  for (std::size_t i = 0; reader.ok() && i < targets; ++i) scene->targets.push_back(GetTarget(reader));
  const std::size_t bodies = reader.GetCount(4);
  for (std::size_t i = 0; reader.ok() && i < bodies; ++i) {
    scene->body_ids.push_back(BodyId{reader.Get<std::uint32_t>()});
  }
  if (!reader.finished() || !Fits(*scene)) return nullptr;
  scene->scenario = scenario;
  return scene;
}

}  // namespace coopdyn
