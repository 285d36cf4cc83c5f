// SPDX-License-Identifier: MIT
#include "server/physics/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace coopdyn {
namespace {

/// A graph of bodies and its matrix, also as a dense one.
class BlockCholeskyTest : public testing::Test {
 protected:
  void Make(int nodes, const std::vector<std::pair<int, int>>& edges, double weight = 100) {
    nodes_ = nodes;
    solver_.Plan(nodes, edges);
    whole_.setZero(6 * nodes, 6 * nodes);
    for (int i = 0; i < nodes; ++i) {
      // The matrix is diagonally dominant.
      const BlockCholesky::Block any = Any();
      solver_.diagonal(i) = any * any.transpose() + weight * BlockCholesky::Block::Identity();
      whole_.block<6, 6>(6 * i, 6 * i) = solver_.diagonal(i);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const BlockCholesky::Block block = Any();
      const auto [a, b] = edges[i];
      if (solver_.is_turned(i)) {
        solver_.edge(i) = block.transpose();
      } else {
        solver_.edge(i) = block;
      }
      whole_.block<6, 6>(6 * a, 6 * b) = block;
      whole_.block<6, 6>(6 * b, 6 * a) = block.transpose();
    }
  }
  void ExpectSolution() {
    Eigen::VectorXd b(6 * nodes_);
    for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = One();
    std::vector<BlockCholesky::Vector> x;
    for (int i = 0; i < nodes_; ++i) x.emplace_back(b.segment<6>(6 * i));
    solver_.Factor();
    solver_.Solve(x);
    const Eigen::VectorXd expected = whole_.ldlt().solve(b);
    for (int i = 0; i < nodes_; ++i) {
      EXPECT_LT((x[static_cast<std::size_t>(i)] - expected.segment<6>(6 * i)).norm(), 1e-12) << i;
    }
  }
  double One() { return static_cast<double>(random_() % 2001) / 1000 - 1; }
  BlockCholesky::Block Any() {
    BlockCholesky::Block block;
    for (double& x : block.reshaped()) x = One();
    return block;
  }

  std::mt19937 random_{7};
  int nodes_ = 0;
  BlockCholesky solver_;
  Eigen::MatrixXd whole_;
};

TEST_F(BlockCholeskyTest, SolvesOneBody) {
  Make(1, {});
  ExpectSolution();
}

TEST_F(BlockCholeskyTest, SolvesATower) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i + 1 < 30; ++i) edges.emplace_back(i, i + 1);
  Make(30, edges);
  ExpectSolution();
}

TEST_F(BlockCholeskyTest, SolvesRodsThatAllCrossEachOther) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 40; ++k) edges.emplace_back(i, 40 + k);
  }
  Make(80, edges, 1000);
  ExpectSolution();
}

TEST_F(BlockCholeskyTest, SolvesAnyGraphOneAfterTheOther) {
  for (int nodes = 2; nodes < 40; nodes += 3) {
    std::set<std::pair<int, int>> edges;
    for (int i = 0; i < 2 * nodes; ++i) {
      const int a = static_cast<int>(random_() % static_cast<unsigned>(nodes));
      const int b = static_cast<int>(random_() % static_cast<unsigned>(nodes));
      if (a != b && !edges.contains({b, a})) edges.emplace(a, b);
    }
    Make(nodes, {edges.begin(), edges.end()});
    ExpectSolution();
  }
}

}  // namespace
}  // namespace coopdyn
