// SPDX-License-Identifier: MIT
// Groups of owners that push each other in this substep, and which solver each group gets.
// Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/ode_world.h"

namespace coopdyn {

/// The direct solver is exact, and cheap in small groups; its cost grows with the cube of a group's
/// constraint rows. Groups beyond this many go to the iterative one. A box on another has 12 rows: stacks up
/// to ten are solved exactly (the iterative solver lets them creep 0.2 mm/s). A robot that stands has 20 and
/// is charged 12 more, since robots come in crowds: groups up to three are solved exactly (up to five would
/// make a crowd 1.5 times as dear).
inline constexpr int kMaxDirectRows = 120;
inline constexpr int kRobotSurcharge = 12;
inline constexpr int kQuickIterations = 40;

/// Union-find over the moving owners. Reused from substep to substep.
class Islands {
 public:
  /// Each owner of `active` alone, with the rows of its own joints and a robot's surcharge.
  void Reset(const OdeWorld& ode, std::span<const std::uint32_t> active);
  void AddRows(std::size_t owner, int rows) { parents_[RootOf(owner)] -= rows; }
  void Join(std::size_t a, std::size_t b);
  /// Rows, surcharges included, of the group that holds `owner`.
  int RowsOf(std::size_t owner) { return -parents_[RootOf(owner)] - 1; }
  /// One member of the group stands for it.
  std::size_t RootOf(std::size_t owner);

 private:
  // Of a root: −1 − its rows; of others: the index of a member nearer to the root.
  std::vector<int> parents_;
};

/// Advances the owners of `active`, whose bodies are the enabled ones, by `dt_s`: small groups by dWorldStep,
/// large ones by dWorldQuickStep. No contact joins the two.
void Solve(OdeWorld& ode, Islands& islands, std::span<const std::uint32_t> active, double dt_s);

}  // namespace coopdyn
