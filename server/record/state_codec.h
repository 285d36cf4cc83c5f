// SPDX-License-Identifier: MIT
// Encodes the exact state of a frame, and a scene, for keyframes and table `scene` (docs/formats.md).
// Little-endian. Pure functions; decoders return null or false for inconsistent bytes.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/base/bytes.h"
#include "server/state/frame.h"
#include "server/state/frame_code.h"
#include "server/state/scene_code.h"

namespace coopdyn {

/// u32 count ≤ 8, count × f64.
void CodeMessage(auto& codec, auto& message) {
  codec.Number(message.count);
  codec.Require(message.count <= RobotMessage::kMaxValues);
  for (std::uint32_t i = 0; codec.ok() && i < message.count; ++i) codec.Number(message.values[i]);
}

/// Encodes all of `state` except the scene (frame, messages, controllers, mode).
std::vector<std::byte> EncodeState(const SavedState& state);
/// Null if the bytes are not a state of `scene`: wrong version, wrong counts, bytes left over.
SavedStatePtr DecodeState(std::span<const std::byte> bytes, std::shared_ptr<const Scene> scene);

/// Encodes objects, robots, targets, floor, lights and body ids of `scene` exactly; models by type.
std::vector<std::byte> EncodeScene(const Scene& scene);
/// Decodes a scene of `scenario`. `model` returns a robot model by type, or null. Returns null if the bytes
/// are inconsistent or a model is missing.
std::shared_ptr<const Scene> DecodeScene(std::span<const std::byte> bytes,
                                         const std::shared_ptr<const Scenario>& scenario,
                                         const FindModel& model, const FindTexture& texture = nullptr);

}  // namespace coopdyn
