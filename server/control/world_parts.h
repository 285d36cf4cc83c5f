// SPDX-License-Identifier: MIT
// Helpers for the edits of /world: names in requests, refusals, and lines. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"
#include "server/control/world_edits.h"
#include "server/state/frame.h"
#include "server/state/world_moves.h"

namespace coopdyn {

ResolvedEdit Refuse(Error error, std::string text);

/// Looks up a name, or an id in digits.
Found FindName(const Scene& scene, std::string_view word);
/// The refusal of an unknown word; suggests a similar name.
ResolvedEdit NoSuchThing(const Scene& scene, std::string_view word);

/// `text` with " | " as line ends, and the text after a [SECTION] on its own line.
std::string WithLines(std::string text);
/// All diagnostics, one per line.
std::string Lined(const Diagnostics& diagnostics);
/// Appends a name, separated by a space.
void AddTo(std::string& names, const std::string& name);

}  // namespace coopdyn
