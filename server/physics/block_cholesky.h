// SPDX-License-Identifier: MIT
// Linear systems of touching bodies: symmetric and positive definite, with a block of 6 × 6 for each body and
// for each touching pair. Factored as L D Lᵀ in blocks, in an order that keeps most zeros (approximate
// minimum degree: P. R. Amestoy, T. A. Davis, I. S. Duff (1996), SIAM J. Matrix Anal. Appl. 17(4)).
// Deterministic. One thread each. Only server/physics includes this file.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace coopdyn {

class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;

  /// Sets the structure: `nodes` block rows, and an off-diagonal block for each of `edges`. All blocks become
  /// zero.
  void Plan(int nodes, std::span<const std::pair<int, int>> edges);
  void Clear();
  /// The node's diagonal block, for the caller to fill in. Only its lower triangle counts.
  Block& diagonal(int node) { return diagonal_[order_of_[static_cast<std::size_t>(node)]]; }
  /// The edge's block, for the caller to fill in: that in the row of its first node and the column of its
  /// second, or the transposed one if is_turned().
  Block& edge(std::size_t edge) { return blocks_[slots_[edge].at]; }
  bool is_turned(std::size_t edge) const { return slots_[edge].turned; }
  /// @pre positive definite
  void Factor();
  /// Replaces `x` (by node) by the solution y of A y = x. Call after Factor().
  void Solve(std::span<Vector> x);

 private:
  struct Slot {
    std::size_t at = 0;  // of blocks_
    bool turned = false;
  };
  /// Chooses the elimination order.
  void Order(int nodes, std::span<const std::pair<int, int>> edges);

  std::vector<std::size_t> order_of_;  // by node
  std::vector<Slot> slots_;            // by edge
  // By column, in elimination order. A column lists its rows below the diagonal that have blocks, increasing.
  std::vector<std::size_t> first_;  // of rows_ and blocks_, plus the end
  std::vector<std::size_t> rows_;
  std::vector<Block> diagonal_;  // factored by Factor(), with inverted pivots
  std::vector<Block> blocks_;
  std::vector<Vector> ordered_;
  std::vector<std::vector<std::size_t>> patterns_, children_;
  std::vector<std::size_t> marks_;
};

}  // namespace coopdyn
