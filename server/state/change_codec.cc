// SPDX-License-Identifier: MIT
#include "server/state/change_codec.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "server/model/mesh_file.h"
#include "server/state/frame_code.h"

namespace coopdyn {

namespace {

// Changes without motions, then without watchdogs, then without drive trains use the older, shorter versions.
constexpr std::uint8_t kVersion = 4, kWithoutMotions = 3, kWithoutWatchdogs = 2, kWithoutTrains = 1;
// Least encoded size of each, bytes.
constexpr std::size_t kObjectBytes = 100, kRobotBytes = 130, kTargetBytes = 60, kLightBytes = 65;

void CodeIds(auto& codec, auto& ids) {
  codec.List(ids, 4, [&codec](auto& id) {
    codec.Number(id.value);
    codec.Require(id.value != 0);
  });
}

template <typename Codec>
void CodePut(Codec& codec, auto& put, const SceneContext& context, bool has_trains = false) {
  using Put = std::decay_t<decltype(put)>;
  codec.Number(put.id.value);
  codec.Require(put.id.value != 0);
  codec.Word(put.placing, Placing::kExact);
  if constexpr (std::is_same_v<Put, PutObject>) {
    CodeThing(codec, put.object, context);
    bool has_body = put.body.has_value();
    codec.Bool(has_body);
    if constexpr (Codec::kReads) {
      if (has_body) put.body.emplace();
    }
    if (has_body) CodeBody(codec, *put.body);
  } else {
    CodeEntry(codec, put.entry, context);
    codec.List(put.bodies, kBodyBytes, [&codec](auto& body) { CodeBody(codec, body); });
    codec.List(put.channels, kChannelStateBytes, [&codec](auto& channel) { CodeChannel(codec, channel); });
    codec.List(put.controls, JointControl::kDoubles * 8,
               [&codec](auto& control) { CodeControl(codec, control); });
    if (has_trains) {
      codec.List(put.drive_trains, DriveTrainState::kDoubles * 8,
                 [&codec](auto& train) { CodeDriveTrain(codec, train); });
    }
    codec.List(put.measured, 8, [&codec](auto& value) { codec.Finite(value); });
  }
}

template <typename Codec>
void CodeChange(Codec& codec, auto& change, const SceneContext& context, bool has_trains) {
  CodeIds(codec, change.gone_objects);
  CodeIds(codec, change.gone_robots);
  CodeIds(codec, change.gone_targets);
  codec.List(change.objects, kObjectBytes, [&](auto& put) { CodePut(codec, put, context); });
  codec.List(change.robots, kRobotBytes, [&](auto& put) { CodePut(codec, put, context, has_trains); });
  codec.List(change.targets, kTargetBytes, [&](auto& target) { CodeTarget(codec, target); });
  bool has_lights = change.lights.has_value();
  codec.Bool(has_lights);
  if constexpr (Codec::kReads) {
    if (has_lights) change.lights.emplace();
  }
  if (has_lights) codec.List(*change.lights, kLightBytes, [&codec](auto& light) { CodeLight(codec, light); });
  codec.List(change.rests, 12, [&codec](auto& rest) {
    codec.Number(rest.id);
    codec.Number(rest.counter);
  });
}

}  // namespace

std::string EncodeChange(const WorldChange& change) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  const bool has_motions =
      std::ranges::any_of(change.objects, [](const PutObject& put) { return SaysMotion(put.object); });
  const bool has_watchdogs = has_motions || std::ranges::any_of(change.robots, [](const PutRobot& put) {
                               return put.entry.watchdog_s.has_value();
                             });
  const bool has_trains = has_watchdogs || std::ranges::any_of(change.robots, [](const PutRobot& put) {
                            return !put.drive_trains.empty();
                          });
  writer.Number(has_motions     ? kVersion
                : has_watchdogs ? kWithoutMotions
                : has_trains    ? kWithoutWatchdogs
                                : kWithoutTrains);
  CodeChange(writer, change, {.watchdogs = has_watchdogs, .motions = has_motions}, has_trains);
  return ToBase64(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::optional<WorldChange> DecodeChange(std::string_view text, const SceneContext& context) {
  const std::optional<std::string> bytes = FromBase64(text);
  if (!bytes) return std::nullopt;
  ByteReader reader(std::as_bytes(std::span(*bytes)));
  const std::uint64_t version = reader.Low(1);
  if (version < kWithoutTrains || version > kVersion) return std::nullopt;
  WorldChange change;
  SceneContext said = context;
  said.watchdogs = version >= kWithoutMotions;
  said.motions = version == kVersion;
  CodeChange(reader, change, said, version != kWithoutTrains);
  constexpr std::size_t kPadding = 2;  // of base64
  if (!reader.ok() || reader.left() > kPadding) return std::nullopt;
  return change;
}

}  // namespace coopdyn
