// SPDX-License-Identifier: MIT
// [FLOOR] and objects: the sections that .world and .scenario share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/model/section_reader.h"
#include "server/model/world_model.h"

namespace coopdyn {

/// Reads [FLOOR]; `angles` in it is read by SaysDegrees.
Floor ReadFloor(SectionReader& reader);

/// What an object's section says: one at its position, or copies by `count`; neither if it has errors.
struct ObjectSection {
  std::optional<WorldObject> object;
  std::optional<ScatteredObjects> scattered;
};

/// Reads a box, cylinder or sphere. `hint`: what its section's name may have been meant to be.
ObjectSection ReadObject(SectionReader& reader, const std::string& hint);

/// `area x y length width`; nothing if missing or wrong (then reported).
std::optional<FloorArea> ReadArea(SectionReader& reader);

/// The most that one [SWARM_n] or one object's section may have.
inline constexpr std::uint64_t kMaxSwarm = 100'000;
/// The most that all [SWARM_n] together may have, and likewise all objects' sections with a count.
inline constexpr std::uint64_t kMaxSwarms = 200'000;

/// Whether `word` is `kind`, or `kind_` and more: robot, robot_1.
bool IsNumbered(const std::string& word, const std::string& kind);

}  // namespace coopdyn
