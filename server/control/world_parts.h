// SPDX-License-Identifier: MIT
// What the edits of /world share: names that requests use, refusals, and lines. Pure; any thread.
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

/// A name, or an id in digits.
Found FindName(const Scene& scene, std::string_view word);
/// The refusal of an unknown word; it names what is near.
ResolvedEdit NoSuchThing(const Scene& scene, std::string_view word);

/// `text` with " | " as line ends, and what follows a [SECTION] on a line of its own.
std::string WithLines(std::string text);
/// All diagnostics, one a line.
std::string Lined(const Diagnostics& diagnostics);
/// Adds one name more, after a space.
void AddTo(std::string& names, const std::string& name);

}  // namespace coopdyn
