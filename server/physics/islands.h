// SPDX-License-Identifier: MIT
// Groups of things that push each other in this substep, and which solver each group gets.
// Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace coopdyn {

/// The direct solver is exact, and cheap in small groups; its cost grows with the cube of a group's
/// constraint rows. Groups beyond this many go to the iterative one. A box on another has 12 rows: stacks up
/// to ten are solved exactly (the iterative solver lets them creep 0.2 mm/s). A robot that stands has 20 and
/// is charged 12 more, since robots come in crowds: groups up to three are solved exactly (up to five would
/// make a crowd 1.5 times as dear).
inline constexpr int kMaxDirectRows = 120;
inline constexpr int kRobotSurcharge = 12;
inline constexpr int kQuickIterations = 40;

/// Union-find over the moving things. Reused from substep to substep.
class Islands {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// For things 0 … count − 1.
  void Resize(std::size_t count);
  /// Begins with `thing` alone, with `rows` of its own.
  void Begin(std::uint32_t thing, int rows) { parents_[thing] = -1 - rows; }
  void AddRows(std::uint32_t thing, int rows) { parents_[RootOf(thing)] -= rows; }
  void Join(std::uint32_t a, std::uint32_t b);
  /// Rows, surcharges included, of the group that holds `thing`.
  int RowsOf(std::uint32_t thing) { return -parents_[RootOf(thing)] - 1; }
  /// One member of the group stands for it.
  std::uint32_t RootOf(std::uint32_t thing);

  /// After the last Join(): lists the groups that `active` (increasing) makes up, by their first member.
  void List(std::span<const std::uint32_t> active);
  /// Roots of the groups, and each group's members, increasing: from FirstOf(root) on by NextOf(thing), until
  /// kNone.
  std::span<const std::uint32_t> roots() const { return roots_; }
  std::uint32_t FirstOf(std::uint32_t root) const { return first_[root]; }
  std::uint32_t NextOf(std::uint32_t thing) const { return next_[thing]; }

 private:
  // Of a root: −1 − its rows; of others: the index of a member nearer to the root.
  std::vector<int> parents_;
  std::vector<std::uint32_t> roots_, first_, last_, next_;
};

}  // namespace coopdyn
