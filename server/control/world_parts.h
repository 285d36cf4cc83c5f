// SPDX-License-Identifier: MIT
// What the edits of /world share: names and ids that requests use, things as they stand now, and lines. Pure;
// any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"
#include "server/control/world_edits.h"
#include "server/state/frame.h"

namespace coopdyn {

ResolvedEdit Refuse(Error error, std::string text);

/// What a name or an id means: indices into the scene; all -1: nothing.
struct Found {
  int object = -1, robot = -1, target = -1, light = -1;
  bool any() const { return object >= 0 || robot >= 0 || target >= 0 || light >= 0; }
};
Found FindId(const Scene& scene, std::int32_t id);
/// A name, or an id in digits.
Found FindName(const Scene& scene, std::string_view word);
/// The refusal of an unknown word; it names what is near.
ResolvedEdit NoSuchThing(const Scene& scene, std::string_view word);
const SceneObject& ObjectAt(const Scene& scene, int place);
const SceneRobot& RobotAt(const Scene& scene, int place);

/// The description of a thing with its present place; one that was not moved has the very numbers it had.
WorldObject ObjectNow(const Frame& frame, const SceneObject& thing);
RobotEntry RobotNow(const Frame& frame, int place);

/// `text` with " | " as line ends, and what follows a [SECTION] on a line of its own.
std::string WithLines(std::string text);
/// All diagnostics, one a line.
std::string Lined(const Diagnostics& diagnostics);
/// Adds one name more, after a space.
void AddTo(std::string& names, const std::string& name);

}  // namespace coopdyn
