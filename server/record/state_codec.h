// SPDX-License-Identifier: MIT
// The exact state of a frame, and a scene, as bytes: what keyframes and table `scene` hold (docs/formats.md).
// Little-endian. Pure functions; a decoder returns null or false for bytes that do not add up.
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

/// All of `state` but the scene (frame, messages, controllers, mode).
std::vector<std::byte> EncodeState(const SavedState& state);
/// Null if the bytes are not a state of `scene`: wrong version, wrong counts, what is left over.
SavedStatePtr DecodeState(std::span<const std::byte> bytes, std::shared_ptr<const Scene> scene);

/// Objects, robots, targets, floor and body ids of `scene`, exactly; models by type.
std::vector<std::byte> EncodeScene(const Scene& scene);
/// The scene of `scenario` as it was encoded. `model` gives a robot model by type, null if there is none.
/// Null if the bytes do not add up or a model is missing.
std::shared_ptr<const Scene> DecodeScene(std::span<const std::byte> bytes,
                                         const std::shared_ptr<const Scenario>& scenario,
                                         const FindModel& model, const FindTexture& texture = nullptr);

}  // namespace coopdyn
