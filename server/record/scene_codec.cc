// SPDX-License-Identifier: MIT
// Implements EncodeScene() and DecodeScene() of state_codec.h.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

#include "server/base/bytes.h"
#include "server/model/scenario.h"
#include "server/record/state_codec.h"
#include "server/state/scene_code.h"

namespace coopdyn {

namespace {

// A scene without motions or watchdogs is written in the older version without them.
constexpr std::uint8_t kSceneVersion = 5, kWithoutMotions = 4, kWithoutWatchdogs = 3, kWithoutTextures = 2;
// Least bytes of each, so that a count cannot request more memory than the bytes justify.
constexpr std::size_t kObjectBytes = 100, kRobotBytes = 146, kTargetBytes = 60, kLightBytes = 65;

void CodeRobot(auto& codec, auto& robot, const SceneContext& context) {
  codec.Number(robot.id.value);
  CodeEntry(codec, robot.entry, context);
  codec.Number(robot.first_body);
  codec.Number(robot.body_count);
  CodePose(codec, robot.X_BR);
  codec.Bool(robot.axes_of_R);
}

void CodeScene(auto& codec, auto& scene, const SceneContext& context) {
  CodeFloor(codec, scene.floor, context);
  codec.List(scene.objects, kObjectBytes, [&](auto& object) { CodeObject(codec, object, context); });
  codec.List(scene.robots, kRobotBytes, [&](auto& robot) { CodeRobot(codec, robot, context); });
  codec.List(scene.targets, kTargetBytes, [&codec](auto& target) { CodeTarget(codec, target); });
  codec.List(scene.body_ids, 4, [&codec](auto& body) { codec.Number(body.value); });
  if (!context.textures) return;
  codec.List(scene.lights, kLightBytes, [&codec](auto& light) { CodeLight(codec, light); });
  codec.AtLeast(0, scene.ambient_light);
}

/// Older recordings do not contain lights: use those of the scenario.
void TakeLights(Scene& scene) {
  if (scene.scenario == nullptr) return;
  scene.lights = scene.scenario->lights;
  scene.ambient_light = scene.scenario->ambient_light;
}

/// Things of the scenario share its textures; things added later have their own.
void TakeTextures(Scene& scene) {
  if (scene.scenario == nullptr) return;
  const auto take = [](Texture& texture, const Texture& of) {
    if (texture.image == nullptr && (texture.name.empty() || texture.name == of.name)) texture = of;
  };
  const std::vector<WorldObject>& objects = scene.scenario->objects;
  take(scene.floor.texture, scene.scenario->floor.texture);
  for (SceneObject& thing : scene.objects) {
    const std::size_t place = thing.id.value - 1;
    if (place < objects.size() && objects[place].name == thing.object.name)
      take(thing.object.texture, objects[place].texture);
  }
}

/// Every dynamic body belongs to one thing or robot, every index is in range, ids increase.
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
  const bool has_motions =
      std::ranges::any_of(scene.objects, [](const SceneObject& thing) { return SaysMotion(thing.object); });
  const bool has_watchdogs = has_motions || std::ranges::any_of(scene.robots, [](const SceneRobot& robot) {
                               return robot.entry.watchdog_s.has_value();
                             });
  writer.Number(has_motions ? kSceneVersion : has_watchdogs ? kWithoutMotions : kWithoutWatchdogs);
  CodeScene(writer, scene, {.watchdogs = has_watchdogs, .motions = has_motions});
  return bytes;
}

std::shared_ptr<const Scene> DecodeScene(std::span<const std::byte> bytes,
                                         const std::shared_ptr<const Scenario>& scenario,
                                         const FindModel& model, const FindTexture& texture) {
  auto scene = std::make_shared<Scene>();
  ByteReader reader(bytes);
  const std::uint64_t version = reader.Low(1);
  if (version < kWithoutTextures || version > kSceneVersion) return nullptr;
  const bool has_textures = version != kWithoutTextures;
  CodeScene(reader, *scene,
            {scenario.get(), &model, texture ? &texture : nullptr, has_textures, version >= kWithoutMotions,
             version == kSceneVersion});
  if (!reader.finished() || !Fits(*scene)) return nullptr;
  for (SceneRobot& robot : std::exchange(scene->robots, {})) AddRobot(*scene, std::move(robot));
  scene->scenario = scenario;
  scene->measures_contacts |= scenario != nullptr && CountsCollisions(*scenario);
  if (!has_textures) TakeLights(*scene);
  TakeTextures(*scene);
  return scene;
}

}  // namespace coopdyn
