// SPDX-License-Identifier: MIT
// Groups of things that push each other in this substep; their size decides which of ODE's solvers they get.
// Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace coopdyn {

/// The direct solver is exact, and cheap in small groups; its cost grows with the cube of a group's
/// constraint rows. Groups with more than kMaxDirectRows go to the iterative solver. A box on another has 12
/// rows: stacks of up to ten are solved exactly (with the iterative solver they creep at 0.2 mm/s). A
/// standing robot has 20 rows, and is charged 12 more because robots come in crowds: groups of up to three
/// are solved exactly (a limit of five would make a crowd 1.5 times as expensive).
inline constexpr int kMaxDirectRows = 120;
inline constexpr int kRobotSurcharge = 12;
inline constexpr int kQuickIterations = 40;

/// Union-find over the moving things. Reused from substep to substep.
class Islands {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// For things 0 … count − 1.
  void Resize(std::size_t count);
  /// Starts a group that consists of `thing`, which has `rows` rows.
  void Begin(std::uint32_t thing, int rows) { parents_[thing] = -1 - rows; }
  void AddRows(std::uint32_t thing, int rows) { parents_[RootOf(thing)] -= rows; }
  void Join(std::uint32_t a, std::uint32_t b);
  /// Rows, including surcharges, of the group that contains `thing`.
  int RowsOf(std::uint32_t thing) { return -parents_[RootOf(thing)] - 1; }
  /// The member that represents the group of `thing`.
  std::uint32_t RootOf(std::uint32_t thing);

  /// Lists the groups of `active` (increasing), ordered by their first members. Call after the last Join().
  void List(std::span<const std::uint32_t> active);
  /// Roots of the groups. A group's members, increasing, are FirstOf(root), then NextOf(thing) until kNone.
  std::span<const std::uint32_t> roots() const { return roots_; }
  std::uint32_t FirstOf(std::uint32_t root) const { return first_[root]; }
  std::uint32_t NextOf(std::uint32_t thing) const { return next_[thing]; }

 private:
  // At a root: −1 − the group's rows. Elsewhere: the index of a member nearer to the root.
  std::vector<int> parents_;
  std::vector<std::uint32_t> roots_, first_, last_, next_;
};

}  // namespace coopdyn
