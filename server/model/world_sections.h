// SPDX-License-Identifier: MIT
// [FLOOR] and objects: the sections that .world and .scenario share.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>

#include "server/model/section_reader.h"
#include "server/model/world_model.h"

namespace coopdyn {

/// Reads [FLOOR]; `angles` in it is read by SaysDegrees.
Floor ReadFloor(SectionReader& reader);

/// Reads a box, cylinder or sphere. Nothing if it has errors. `hint`: what its section's name may have been
/// meant to be.
std::optional<WorldObject> ReadObject(SectionReader& reader, const std::string& hint);

/// Whether `word` is `kind`, or `kind_` and more: robot, robot_1.
bool IsNumbered(const std::string& word, const std::string& kind);

}  // namespace coopdyn
