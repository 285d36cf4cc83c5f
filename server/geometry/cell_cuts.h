// SPDX-License-Identifier: MIT
// Boxes of cells, and the plane that cuts one best. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "server/geometry/cell_grid.h"
#include "server/geometry/lattice_hull.h"

namespace coopdyn {

/// The cells from `low` to before `high`.
struct CellBox {
  std::array<int, 3> low{}, high{};
};

/// The solid cells in a box that they fill from side to side.
struct Piece {
  CellBox box;
  LatticeHull hull;
  std::int64_t cells6 = 0;  // six times their volume

  /// Six times what its hull holds besides them; 0 for a single cell, which no plane cuts.
  std::int64_t around6() const { return hull.volume6() - cells6; }
};

/// All solid cells; nothing if there are none.
std::optional<Piece> WholeOf(const CellGrid& grid);
/// By the plane that cuts it best.
/// @pre it has more than one cell
std::pair<Piece, Piece> CutInTwo(const CellGrid& grid, const Piece& piece);

}  // namespace coopdyn
