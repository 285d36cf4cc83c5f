// SPDX-License-Identifier: MIT
// Encodes a change of the world as text, base64 of bytes, for the inputs of recordings (docs/formats.md).
// Pure; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/state/scene_code.h"
#include "server/state/world_change.h"

namespace coopdyn {

/// Omits the label.
std::string EncodeChange(const WorldChange& change);
/// Nullopt if `text` is no change, or names a model that `context` does not have.
std::optional<WorldChange> DecodeChange(std::string_view text, const SceneContext& context);

}  // namespace coopdyn
