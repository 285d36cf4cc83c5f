// SPDX-License-Identifier: MIT
// The linear complementarity problem with bounds: A x − w = b, where each x is within its bounds and
// w = 0, or at its lower bound and w ≥ 0, or at its upper one and w ≤ 0. Pure; deterministic.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace coopdyn {

class BoxLcp {
 public:
  /// Block principal pivoting, with Murty's rule where it makes no progress: J. J. Júdice and F. M. Pires
  /// (1994), "A block principal pivoting algorithm for large-scale strictly monotone linear complementarity
  /// problems", Computers & Operations Research 21(5). `A` is symmetric and positive definite; lower ≤ 0 ≤
  /// upper, which may be infinite. Starts from `x` of the last call if it has as many rows. Returns whether
  /// it was solved; else x is within its bounds and near.
  bool Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  enum class State : signed char { kLower = -1, kFree = 0, kUpper = 1 };

  std::vector<State> states_;
  std::vector<Eigen::Index> free_, wrong_;
  Eigen::MatrixXd part_;
  Eigen::VectorXd rest_, w_;
};

}  // namespace coopdyn
