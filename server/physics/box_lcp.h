// SPDX-License-Identifier: MIT
// The linear complementarity problem with bounds: A x − w = b, where each x is within its bounds and
// w = 0, or at its lower bound and w ≥ 0, or at its upper one and w ≤ 0. Deterministic. One thread each.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace coopdyn {

class BoxLcp {
 public:
  /// Block principal pivoting (J. J. Júdice and F. M. Pires (1994), "A block principal pivoting algorithm for
  /// large-scale strictly monotone linear complementarity problems", Computers & Operations Research 21(5));
  /// where it makes no progress an active set, which does at each step. `A` is symmetric and positive
  /// definite; lower ≤ upper, which may be infinite. Begins where the last call has ended: which rows are at
  /// which bound. Returns whether it was solved; else x is within its bounds and near.
  bool Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, Eigen::VectorXd& x);
  /// The next call begins with all rows free.
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
  /// Puts rows that are at a bound there, and solves for the others: to `solution_`.
  void SolveFree(const Problem& problem, Eigen::VectorXd& x);
  State& state(Eigen::Index i) { return states_[static_cast<std::size_t>(i)]; }

  std::vector<State> states_;
  std::vector<Eigen::Index> free_, wrong_;
  Eigen::MatrixXd factor_;
  Eigen::VectorXd solution_, w_;
};

}  // namespace coopdyn
