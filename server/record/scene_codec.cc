// SPDX-License-Identifier: MIT
// EncodeScene() and DecodeScene() of state_codec.h.
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

#include "server/base/bytes.h"
#include "server/record/state_codec.h"

namespace coopdyn {

namespace {

constexpr std::uint8_t kSceneVersion = 2;
constexpr std::uint8_t kNothing = 255;  // instead of an optional word
// Least bytes of each, so that a count cannot ask for more memory than there are bytes.
constexpr std::size_t kObjectBytes = 100, kRobotBytes = 146, kTargetBytes = 60;

using FindModel = std::function<std::shared_ptr<const RobotModel>(const std::string& type)>;

/// What a reader needs besides the bytes; an encoder needs none of it.
struct Context {
  const Scenario* scenario = nullptr;
  const FindModel* model = nullptr;
};

void CodePose(auto& codec, auto& X) {
  codec.Finite(X.p);
  codec.Finite(X.q.coeffs());  // x y z w
  codec.Require(std::abs(X.q.norm() - 1) <= 1e-6);
}

void CodeColor(auto& codec, auto& color) {
  codec.Finite(color.r);
  codec.Finite(color.g);
  codec.Finite(color.b);
}

void CodeWhere(auto& codec, auto& where) {
  codec.Text(where.file);
  codec.Number(where.line);
}

/// Goes on to the kind of shape that the bytes name.
void DecodeKind(ByteReader& reader, Shape& shape) {
  const std::uint64_t kind = reader.Low(1);
  if (kind == 0) {
    shape = Box{Vector3::Zero()};
  } else if (kind == 1) {
    shape = Cylinder{0, 0};
  } else {
    reader.Require(kind == 2);
    shape = Sphere{0};
  }
}

template <typename Codec>
void CodeShape(Codec& codec, auto& shape) {
  if constexpr (Codec::kReads) {
    DecodeKind(codec, shape);
  } else {
    codec.Number(static_cast<std::uint8_t>(shape.index()));
  }
  std::visit(
      [&codec](auto& kind) {
        using Kind = std::decay_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, Box>) {
          for (auto& size_m : kind.size_m) codec.Size(size_m);
        } else if constexpr (!std::is_same_v<Kind, Mesh>) {  // no object is a mesh
          codec.Size(kind.radius_m);
          if constexpr (std::is_same_v<Kind, Cylinder>) codec.Size(kind.length_m);
        }
      },
      shape);
}

void CodeFloor(auto& codec, auto& floor) {
  codec.Size(floor.length_m);
  codec.Size(floor.width_m);
  codec.AtLeast(0, floor.height_m);
  CodeColor(codec, floor.color);
  codec.AtLeast(0, floor.friction);
  CodeWhere(codec, floor.where);
}

void CodeObject(auto& codec, auto& thing) {
  codec.Number(thing.id.value);
  codec.Number(thing.body);
  codec.Text(thing.object.name);
  CodeShape(codec, thing.object.shape);
  CodePose(codec, thing.object.X_WO);
  codec.Finite(thing.object.mass_kg);
  CodeColor(codec, thing.object.color);
  codec.AtLeast(0, thing.object.friction);
  CodeWhere(codec, thing.object.where);
}

void CodeTarget(auto& codec, auto& target) {
  codec.Number(target.id.value);
  codec.Text(target.color_name);
  CodeColor(codec, target.color);
  codec.Finite(target.p_WT);
  CodeWhere(codec, target.where);
}

/// Without the file: a recording of unknown origin must not say what code is loaded.
template <typename Codec>
void CodeController(Codec& codec, auto& controller, const Context& context) {
  codec.Text(controller.name);
  codec.List(controller.options, 4 + 8, [&codec](auto& option) {
    codec.Text(option.first);
    codec.Number(option.second);
  });
  CodeWhere(codec, controller.where);
  if constexpr (Codec::kReads) {
    if (controller.empty()) return;
    for (const RobotEntry& entry : context.scenario->robots) {
      if (entry.controller.name != controller.name) continue;
      controller.file = entry.controller.file;
      break;
    }
  }
}

void CodeModel(ByteWriter& writer, const std::shared_ptr<const RobotModel>& model,
               const Context& /*context*/) {
  writer.Text(model->type);
}

void CodeModel(ByteReader& reader, std::shared_ptr<const RobotModel>& model, const Context& context) {
  std::string type;
  reader.Text(type);
  if (reader.ok()) model = (*context.model)(type);
  reader.Require(model != nullptr && !model->links.empty());
}

template <typename Codec>
void CodeEntry(Codec& codec, auto& entry, const Context& context) {
  codec.Number(entry.id.value);
  codec.Text(entry.name);
  CodeModel(codec, entry.model, context);
  CodePose(codec, entry.X_WR);
  CodeColor(codec, entry.color);
  codec.Bool(entry.sync);
  codec.List(entry.waits_for, 4, [&codec](auto& module) { codec.Text(module); });
  bool has_deadline = entry.deadline_s.has_value();
  double deadline_s = entry.deadline_s.value_or(0);
  codec.Bool(has_deadline);
  codec.Finite(deadline_s);
  codec.Word(entry.on_deadline, LossPolicy::kDrop);
  std::uint8_t on_disconnect =
      entry.on_disconnect ? static_cast<std::uint8_t>(*entry.on_disconnect) : kNothing;
  codec.Number(on_disconnect);
  codec.Word(entry.fidelity, Fidelity::kPlanar);
  CodeController(codec, entry.controller, context);
  codec.Bool(entry.sockets);
  CodeWhere(codec, entry.where);
  if constexpr (Codec::kReads) {
    if (has_deadline) entry.deadline_s = deadline_s;
    if (on_disconnect == kNothing) return;
    codec.Require(on_disconnect <= static_cast<std::uint8_t>(LossPolicy::kDrop));
    entry.on_disconnect = static_cast<LossPolicy>(on_disconnect);
  }
}

void CodeRobot(auto& codec, auto& robot, const Context& context) {
  codec.Number(robot.id.value);
  CodeEntry(codec, robot.entry, context);
  codec.Number(robot.first_body);
  codec.Number(robot.body_count);
  CodePose(codec, robot.X_BR);
  codec.Bool(robot.axes_of_R);
}

void CodeScene(auto& codec, auto& scene, const Context& context) {
  CodeFloor(codec, scene.floor);
  codec.List(scene.objects, kObjectBytes, [&codec](auto& object) { CodeObject(codec, object); });
  codec.List(scene.robots, kRobotBytes, [&](auto& robot) { CodeRobot(codec, robot, context); });
  codec.List(scene.targets, kTargetBytes, [&codec](auto& target) { CodeTarget(codec, target); });
  codec.List(scene.body_ids, 4, [&codec](auto& body) { codec.Number(body.value); });
}

/// Textures are those of the scenario; what was added later has none.
void TakeTextures(Scene& scene) {
  if (scene.scenario == nullptr) return;
  const std::vector<WorldObject>& objects = scene.scenario->objects;
  scene.floor.texture = scene.scenario->floor.texture;
  for (SceneObject& thing : scene.objects) {
    const std::size_t place = thing.id.value - 1;
    if (place < objects.size() && objects[place].name == thing.object.name)
      thing.object.texture = objects[place].texture;
  }
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
  writer.Number(kSceneVersion);
  CodeScene(writer, scene, {});
  return bytes;
}

std::shared_ptr<const Scene> DecodeScene(std::span<const std::byte> bytes,
                                         const std::shared_ptr<const Scenario>& scenario,
                                         const FindModel& model) {
  auto scene = std::make_shared<Scene>();
  ByteReader reader(bytes);
  if (reader.Low(1) != kSceneVersion) return nullptr;
  CodeScene(reader, *scene, {scenario.get(), &model});
  if (!reader.finished() || !Fits(*scene)) return nullptr;
  for (SceneRobot& robot : std::exchange(scene->robots, {})) AddRobot(*scene, std::move(robot));
  scene->scenario = scenario;
  TakeTextures(*scene);
  return scene;
}

}  // namespace coopdyn
