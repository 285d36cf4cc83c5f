// SPDX-License-Identifier: MIT
// Groups of owners that push each other in this substep, and which solver each group gets.
// Only server/physics includes this file.
#pragma once

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
  /// Every owner alone, with the rows of its own joints and a robot's surcharge.
  void Reset(const OdeWorld& ode);
  void AddRows(std::size_t owner, int rows) { parents_[Root(owner)] -= rows; }
  void Join(std::size_t a, std::size_t b);
  /// Rows, surcharges included, of the group that holds `owner`.
  int RowsOf(std::size_t owner) { return -parents_[Root(owner)] - 1; }

 private:
  std::size_t Root(std::size_t owner);
  // Of a root: −1 − its rows; of others: the index of a member nearer to the root.
  std::vector<int> parents_;
};

/// Advances all bodies by `dt_s`: small groups by dWorldStep, large ones by dWorldQuickStep. No contact joins
/// the two.
void Solve(OdeWorld& ode, Islands& islands, double dt_s);

}  // namespace coopdyn
