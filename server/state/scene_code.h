// SPDX-License-Identifier: MIT
// Codecs for the parts of a scene, for both directions (server/base/bytes.h), as in table `scene` of a
// recording and in changes of the world (docs/formats.md). Pure; any thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "server/base/bytes.h"
#include "server/model/textures.h"
#include "server/state/scene.h"

namespace coopdyn {

inline constexpr std::uint8_t kNoPolicy = 255;  // in place of an optional policy
inline constexpr double kNotSaid = -1;          // in place of an optional time

/// Returns the robot model of a type; null if there is none.
using FindModel = std::function<std::shared_ptr<const RobotModel>(const std::string& type)>;
/// Returns a texture's picture and file by its key among the texts of a recording; empty if there is none.
using FindTexture = std::function<Texture(const std::string& key)>;

/// A reader's input besides the bytes; an encoder needs only the flags.
struct SceneContext {
  const Scenario* scenario = nullptr;
  const FindModel* model = nullptr;
  const FindTexture* texture = nullptr;  // null: pictures from files are omitted
  bool textures = true;                  // the bytes contain textures
  bool watchdogs = false;                // the bytes contain watchdogs
  bool motions = false;                  // the bytes contain motions, restitution and rolling friction
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

/// Sets `shape` to the kind that the bytes name.
inline void DecodeKind(ByteReader& reader, Shape& shape) {
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
        } else if constexpr (!std::is_same_v<Kind, Mesh>) {  // objects are never meshes
          codec.Size(kind.radius_m);
          if constexpr (std::is_same_v<Kind, Cylinder>) codec.Size(kind.length_m);
        }
      },
      shape);
}

/// `color`: of the textured thing.
template <typename Codec>
void CodeTexture(Codec& codec, auto& texture, const Color& color, const SceneContext& context) {
  std::string key;
  if constexpr (!Codec::kReads) {
    if (texture.source != nullptr) key = texture.source->name;
  }
  codec.Text(texture.name);
  codec.Text(key);
  codec.Size(texture.width_m);
  codec.Size(texture.height_m);
  if constexpr (Codec::kReads) {
    texture.image = PatternOf(texture.name, color);
    if (texture.image != nullptr || key.empty() || context.texture == nullptr || !*context.texture) return;
    Texture found = (*context.texture)(key);
    texture.image = std::move(found.image);
    texture.source = std::move(found.source);
  }
}

void CodeLight(auto& codec, auto& light) {
  codec.Text(light.name);
  codec.Finite(light.p_WP);
  CodeColor(codec, light.color);
  codec.AtLeast(0, light.power);
  codec.Bool(light.casts_shadows);
  CodeWhere(codec, light.where);
}

void CodeFloor(auto& codec, auto& floor, const SceneContext& context) {
  codec.Size(floor.length_m);
  codec.Size(floor.width_m);
  codec.AtLeast(0, floor.height_m);
  CodeColor(codec, floor.color);
  codec.AtLeast(0, floor.friction);
  CodeWhere(codec, floor.where);
  if (context.textures) CodeTexture(codec, floor.texture, floor.color, context);
}

/// Omits id and body.
void CodeThing(auto& codec, auto& object, const SceneContext& context) {
  codec.Text(object.name);
  CodeShape(codec, object.shape);
  CodePose(codec, object.X_WO);
  codec.Finite(object.mass_kg);
  CodeColor(codec, object.color);
  codec.AtLeast(0, object.friction);
  CodeWhere(codec, object.where);
  if (context.textures) CodeTexture(codec, object.texture, object.color, context);
  if (!context.motions) return;
  codec.AtLeast(0, object.restitution);
  codec.Require(object.restitution <= 1);
  codec.AtLeast(0, object.rolling_friction_m);
  codec.Finite(object.v_WO);
  codec.Finite(object.w_WO);
}

/// True if the thing has data that CodeThing() omits without `motions`.
inline bool SaysMotion(const WorldObject& object) {
  return object.restitution > 0 || object.rolling_friction_m > 0 || !object.v_WO.isZero() ||
         !object.w_WO.isZero();
}

void CodeObject(auto& codec, auto& thing, const SceneContext& context) {
  codec.Number(thing.id.value);
  codec.Number(thing.body);
  CodeThing(codec, thing.object, context);
}

void CodeTarget(auto& codec, auto& target) {
  codec.Number(target.id.value);
  codec.Text(target.color_name);
  CodeColor(codec, target.color);
  codec.Finite(target.p_WT);
  CodeWhere(codec, target.where);
}

/// Omits the file: a recording of unknown origin must not decide which code is loaded.
template <typename Codec>
void CodeController(Codec& codec, auto& controller, const SceneContext& context) {
  codec.Text(controller.name);
  codec.List(controller.options, 4 + 8, [&codec](auto& option) {
    codec.Text(option.first);
    codec.Number(option.second);
  });
  CodeWhere(codec, controller.where);
  if constexpr (Codec::kReads) {
    if (controller.empty() || context.scenario == nullptr) return;
    for (const RobotEntry& entry : context.scenario->robots) {
      if (entry.controller.name != controller.name) continue;
      controller.file = entry.controller.file;
      break;
    }
  }
}

inline void CodeModel(ByteWriter& writer, const std::shared_ptr<const RobotModel>& model,
                      const SceneContext& /*context*/) {
  writer.Text(model->type);
}

inline void CodeModel(ByteReader& reader, std::shared_ptr<const RobotModel>& model,
                      const SceneContext& context) {
  std::string type;
  reader.Text(type);
  if (reader.ok() && context.model != nullptr && *context.model) model = (*context.model)(type);
  reader.Require(model != nullptr && !model->links.empty());
}

template <typename Codec>
void CodeEntry(Codec& codec, auto& entry, const SceneContext& context) {
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
      entry.on_disconnect ? static_cast<std::uint8_t>(*entry.on_disconnect) : kNoPolicy;
  codec.Number(on_disconnect);
  codec.Word(entry.fidelity, Fidelity::kPlanar);
  CodeController(codec, entry.controller, context);
  codec.Bool(entry.sockets);
  CodeWhere(codec, entry.where);
  if (context.watchdogs) {
    double watchdog_s = entry.watchdog_s.value_or(kNotSaid);
    codec.AtLeast(kNotSaid, watchdog_s);
    if constexpr (Codec::kReads) {
      if (watchdog_s >= 0) entry.watchdog_s = watchdog_s;
    }
  }
  if constexpr (Codec::kReads) {
    if (has_deadline) entry.deadline_s = deadline_s;
    if (on_disconnect == kNoPolicy) return;
    codec.Require(on_disconnect <= static_cast<std::uint8_t>(LossPolicy::kDrop));
    entry.on_disconnect = static_cast<LossPolicy>(on_disconnect);
  }
}

}  // namespace coopdyn
