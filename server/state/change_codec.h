// SPDX-License-Identifier: MIT
// A change of the world as text, as inputs of recordings have it (docs/formats.md): base64 of bytes. Pure;
// any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/state/scene_code.h"
#include "server/state/world_change.h"

namespace coopdyn {

/// Without its label.
std::string EncodeChange(const WorldChange& change);
/// Nothing if the text is no change, or names a model that `context` does not have.
std::optional<WorldChange> DecodeChange(std::string_view text, const SceneContext& context);

}  // namespace coopdyn
