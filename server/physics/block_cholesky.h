// SPDX-License-Identifier: MIT
// Linear systems of bodies that touch: symmetric and positive definite, with a block of 6 × 6 for each body
// and for each two that touch. Factored as L D Lᵀ in blocks, in an order that keeps most zeros (approximate
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

  /// A matrix of `nodes` block rows; `edges`: which two of them have a block. All blocks are zero.
  void Plan(int nodes, std::span<const std::pair<int, int>> edges);
  void Clear();
  /// To be filled in.
  Block& diagonal(int node) { return diagonal_[order_of_[static_cast<std::size_t>(node)]]; }
  /// The block in the row of the edge's first node and the column of its second; if it is turned, the other
  /// one.
  Block& edge(std::size_t edge) { return blocks_[slots_[edge].at]; }
  bool is_turned(std::size_t edge) const { return slots_[edge].turned; }
  /// @pre positive definite
  void Factor();
  /// `x`, by node, becomes the solution of A y = x. After Factor().
  void Solve(std::span<Vector> x);

 private:
  struct Slot {
    std::size_t at = 0;  // of blocks_
    bool turned = false;
  };
  /// Which node comes when.
  void Order(int nodes, std::span<const std::pair<int, int>> edges);

  std::vector<std::size_t> order_of_;  // by node
  std::vector<Slot> slots_;            // by edge
  // By column, in that order. Of a column: the rows below the diagonal that have blocks, increasing.
  std::vector<std::size_t> first_;  // of rows_ and blocks_; with the end
  std::vector<std::size_t> rows_;
  std::vector<Block> diagonal_;  // then its inverse
  std::vector<Block> blocks_;    // then times the inverse of their columns' diagonal
  std::vector<Vector> ordered_;
  std::vector<std::vector<std::size_t>> patterns_, children_;
  std::vector<std::size_t> marks_;
};

}  // namespace coopdyn
