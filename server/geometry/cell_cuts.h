// SPDX-License-Identifier: MIT
// Boxes of grid cells, and the best plane to cut one. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "server/geometry/cell_grid.h"
#include "server/geometry/lattice_hull.h"

namespace coopdyn {

/// The cells from `low` (inclusive) to `high` (exclusive).
struct CellBox {
  std::array<int, 3> low{}, high{};
};

/// The solid cells in their tight bounding box.
struct Piece {
  CellBox box;
  LatticeHull hull;
  std::int64_t cells6 = 0;  // six times their volume

  /// Six times the volume of the hull outside the cells; 0 for a single cell, which cannot be cut.
  std::int64_t around6() const { return hull.volume6() - cells6; }
};

/// All solid cells; nullopt if the grid has none.
std::optional<Piece> WholeOf(const CellGrid& grid);
/// Cuts `piece` along the best plane.
/// @pre `piece` has more than one cell
std::pair<Piece, Piece> CutInTwo(const CellGrid& grid, const Piece& piece);

}  // namespace coopdyn
