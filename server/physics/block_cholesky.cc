// SPDX-License-Identifier: MIT
#include "server/physics/block_cholesky.h"

#include <Eigen/SparseCore>
#include <algorithm>

#include <Eigen/OrderingMethods>

namespace coopdyn {

namespace {

using Block = BlockCholesky::Block;

constexpr int kSize = 6;

/// Factors a symmetric and positive definite block as L D Lᵀ. Reads its lower triangle. Stores L below the
/// diagonal, the inverse of D on it, and nothing of use above it.
void FactorBlock(Block& A) {
#pragma GCC unroll 6
  for (int j = 0; j < kSize; ++j) {
    const double inverse = 1 / A(j, j);
    const BlockCholesky::Vector column = inverse * A.col(j);
#pragma GCC unroll 6
    for (int k = j + 1; k < kSize; ++k) A.col(k) -= A(k, j) * column;
    A.col(j) = column;
    A(j, j) = inverse;
  }
}

/// sum −= A Bᵀ.
void Subtract(const Block& A, const Block& B, Block& sum) {
  for (int j = 0; j < kSize; ++j) {
    BlockCholesky::Vector column = sum.col(j);
#pragma GCC unroll 6
    for (int m = 0; m < kSize; ++m) column -= B(j, m) * A.col(m);
    sum.col(j) = column;
  }
}

}  // namespace

void BlockCholesky::Order(int nodes, std::span<const std::pair<int, int>> edges) {
  const auto count = static_cast<std::size_t>(nodes);
  order_of_.resize(count);
  for (std::size_t i = 0; i < count; ++i) order_of_[i] = i;
  constexpr int kFew = 4;  // so few that no order saves work
  if (nodes <= kFew) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < nodes; ++i) entries.emplace_back(i, i, 1);
  for (const auto& [a, b] : edges) {
    entries.emplace_back(a, b, 1);
    entries.emplace_back(b, a, 1);
  }
  Eigen::SparseMatrix<double> graph(nodes, nodes);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(graph, order);
  for (int i = 0; i < nodes; ++i) {
    order_of_[static_cast<std::size_t>(order.indices()[i])] = static_cast<std::size_t>(i);
  }
}

void BlockCholesky::Plan(int nodes, std::span<const std::pair<int, int>> edges) {
  Order(nodes, edges);
  const auto count = static_cast<std::size_t>(nodes);
  if (patterns_.size() < count) {
    patterns_.resize(count);
    children_.resize(count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    patterns_[i].clear();
    children_[i].clear();
  }
  const auto at = [this](int node) { return order_of_[static_cast<std::size_t>(node)]; };
  for (const auto& [a, b] : edges) patterns_[std::min(at(a), at(b))].push_back(std::max(at(a), at(b)));
  first_.assign(1, 0);
  rows_.clear();
  marks_.assign(count, count);
  for (std::size_t column = 0; column < count; ++column) {
    // The column's own rows, and those that eliminating its children adds.
    const std::size_t begin = rows_.size();
    const auto take = [&](std::size_t row) {
      if (row == column || marks_[row] == column) return;
      marks_[row] = column;
      rows_.push_back(row);
    };
    for (const std::size_t row : patterns_[column]) take(row);
    for (const std::size_t child : children_[column]) {
      // By index: rows_ grows.
      for (std::size_t k = first_[child]; k < first_[child + 1]; ++k) take(rows_[k]);
    }
    std::sort(rows_.begin() + static_cast<std::ptrdiff_t>(begin), rows_.end());
    first_.push_back(rows_.size());
    if (rows_.size() > begin) children_[rows_[begin]].push_back(column);
  }
  slots_.clear();
  for (const auto& [a, b] : edges) {
    const std::size_t column = std::min(at(a), at(b)), row = std::max(at(a), at(b));
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(first_[column]);
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(first_[column + 1]);
    const auto found = std::lower_bound(begin, end, row);
    slots_.push_back({static_cast<std::size_t>(found - rows_.begin()), at(a) < at(b)});
  }
  diagonal_.resize(count);
  blocks_.resize(rows_.size());
  ordered_.resize(count);
  Clear();
}

void BlockCholesky::Clear() {
  for (Block& block : diagonal_) block.setZero();
  for (Block& block : blocks_) block.setZero();
}

void BlockCholesky::Factor() {
  for (std::size_t column = 0; column < diagonal_.size(); ++column) {
    Block& pivot = diagonal_[column];
    FactorBlock(pivot);
    const std::size_t begin = first_[column], end = first_[column + 1];
    for (std::size_t k = begin; k < end; ++k) {
      Block& original = blocks_[k];
#pragma GCC unroll 6
      for (int j = 1; j < kSize; ++j) {
#pragma GCC unroll 6
        for (int m = 0; m < j; ++m) original.col(j) -= pivot(j, m) * original.col(m);
      }
      Block scaled;
      for (int j = 0; j < kSize; ++j) scaled.col(j) = pivot(j, j) * original.col(j);
      Subtract(scaled, original, diagonal_[rows_[k]]);
      // This row is also in the columns of the rows above it.
      for (std::size_t i = begin; i < k; ++i) {
        const std::size_t first = first_[rows_[i]];
        const auto to =
            std::lower_bound(rows_.begin() + static_cast<std::ptrdiff_t>(first),
                             rows_.begin() + static_cast<std::ptrdiff_t>(first_[rows_[i] + 1]), rows_[k]);
        Subtract(original, blocks_[i], blocks_[static_cast<std::size_t>(to - rows_.begin())]);
      }
      original = scaled;
    }
  }
}

void BlockCholesky::Solve(std::span<Vector> x) {
  for (std::size_t i = 0; i < x.size(); ++i) ordered_[order_of_[i]] = x[i];
  for (std::size_t column = 0; column < x.size(); ++column) {
    Vector& value = ordered_[column];
    const Block& pivot = diagonal_[column];
#pragma GCC unroll 6
    for (int j = 0; j < kSize; ++j) {
#pragma GCC unroll 6
      for (int i = j + 1; i < kSize; ++i) value[i] -= pivot(i, j) * value[j];
    }
    for (std::size_t k = first_[column]; k < first_[column + 1]; ++k) {
      ordered_[rows_[k]] -= blocks_[k].lazyProduct(value);
    }
  }
  for (std::size_t column = x.size(); column-- > 0;) {
    const Block& pivot = diagonal_[column];
    Vector value = pivot.diagonal().cwiseProduct(ordered_[column]);
    for (std::size_t k = first_[column]; k < first_[column + 1]; ++k) {
      value -= blocks_[k].transpose().lazyProduct(ordered_[rows_[k]]);
    }
#pragma GCC unroll 6
    for (int j = kSize - 1; j >= 0; --j) {
#pragma GCC unroll 6
      for (int i = j + 1; i < kSize; ++i) value[j] -= pivot(i, j) * value[i];
    }
    ordered_[column] = value;
  }
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = ordered_[order_of_[i]];
}

}  // namespace coopdyn
