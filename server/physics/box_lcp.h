// SPDX-License-Identifier: MIT
// The linear complementarity problem with bounds: A x − w = b, where each x is within its bounds and
// w = 0, or at its lower bound and w ≥ 0, or at its upper one and w ≤ 0. Deterministic. One thread each.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace coopdyn {

class BoxLcp {
 public:
  /// Solves the problem by block principal pivoting (J. J. Júdice and F. M. Pires (1994), "A block principal
  /// pivoting algorithm for large-scale strictly monotone linear complementarity problems", Computers &
  /// Operations Research 21(5)); if that makes no progress, by an active-set method, which makes progress at
  /// each step. `A` is symmetric and positive definite; lower ≤ upper, and both may be infinite. Warm start:
  /// begins with the rows at the bounds that the last call found. Returns whether it found the solution; if
  /// not, x is within its bounds and near the solution.
  bool Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, Eigen::VectorXd& x);
  /// Makes the next call begin with all rows free.
  void Forget() { states_.clear(); }

 private:
  enum class State : signed char { kLower = -1, kFree = 0, kUpper = 1 };
  struct Problem {
    const Eigen::MatrixXd& A;
    const Eigen::VectorXd &b, &lower, &upper;
    Eigen::Index rows() const { return b.size(); }
    bool is_fixed(Eigen::Index i) const { return !(lower[i] < upper[i]); }
  };

  bool Pivot(const Problem& problem, Eigen::VectorXd& x);
  bool Descend(const Problem& problem, Eigen::VectorXd& x);
  /// Sets x of the rows at a bound, and solves for the free rows into `solution_`.
  void SolveFree(const Problem& problem, Eigen::VectorXd& x);
  State& state(Eigen::Index i) { return states_[static_cast<std::size_t>(i)]; }

  std::vector<State> states_;
  std::vector<Eigen::Index> free_, wrong_;
  Eigen::MatrixXd factor_;
  Eigen::VectorXd solution_, w_;
};

}  // namespace coopdyn
