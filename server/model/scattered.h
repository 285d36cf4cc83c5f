// SPDX-License-Identifier: MIT
// Objects that a file gives by number instead of position: copies at seeded places. Pure; any thread.
#pragma once

#include <span>

#include "server/base/diagnostics.h"
#include "server/model/scenario.h"
#include "server/model/swarm.h"

namespace coopdyn {

/// Adds the copies of all `sections` to `scenario`, NAME_1 to NAME_count, turned about the vertical at
/// random: clear of the objects there, of the places `taken` and of one another. Then objects are in the
/// order of the files again, the world's first. Reports sections that do not fit, and copies with another's
/// name.
void AddScattered(std::span<const ScatteredObjects> sections, std::span<const FloorPlace> taken,
                  Scenario& scenario, Diagnostics& diagnostics);

}  // namespace coopdyn
