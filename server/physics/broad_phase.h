// SPDX-License-Identifier: MIT
// Which owners may touch: two uniform grids, one of static things (filled once), one of the rest (each
// substep). Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "server/geometry/uniform_grid.h"
#include "server/physics/ode_world.h"

namespace coopdyn {

class BroadPhase {
 public:
  /// Fills the grid of static things.
  explicit BroadPhase(const OdeWorld& ode);

  /// Finds all pairs of owners (a < b) with a moving one that overlap in the plane: first of moving owners,
  /// then of moving and static ones, each in increasing order. Brings the extents of dynamic objects up to
  /// date. The pairs are valid until the next call.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& FindPairs(OdeWorld& ode);

 private:
  std::vector<Aabb2> static_boxes_, moving_boxes_;
  UniformGrid static_grid_, moving_grid_;
  std::vector<std::uint32_t> statics_;  // that overlap one moving box
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

}  // namespace coopdyn
