// SPDX-License-Identifier: MIT
#include "server/physics/box_lcp.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

constexpr double kSlack = 1e-9;  // of x
constexpr double kWSlack = 1e-10;

}  // namespace

bool BoxLcp::Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
  const Problem problem{A, b, lower, upper};
  x.setZero(b.size());
  states_.resize(static_cast<std::size_t>(b.size()), State::kFree);
  const bool solved = Pivot(problem, x) || Descend(problem, x);
  for (Eigen::Index i = 0; i < b.size(); ++i) x[i] = std::clamp(x[i], lower[i], upper[i]);
  return solved;
}

void BoxLcp::SolveFree(const Problem& problem, Eigen::VectorXd& x) {
  const Eigen::Index n = problem.rows();
  free_.clear();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (state(i) == State::kFree && !problem.is_fixed(i)) {
      free_.push_back(i);
    } else {
      x[i] = state(i) == State::kUpper ? problem.upper[i] : problem.lower[i];
    }
  }
  const auto m = static_cast<Eigen::Index>(free_.size());
  factor_.resize(n, n);
  solution_.resize(n);
  w_.resize(n);
  // The right-hand side less the fixed rows' part; then L D Lᵀ, row by row, and both substitutions.
  for (Eigen::Index r = 0; r < m; ++r) w_[r] = problem.b[free_[static_cast<std::size_t>(r)]];
  for (Eigen::Index j = 0, next = 0; j < n; ++j) {
    if (next < m && free_[static_cast<std::size_t>(next)] == j) {
      ++next;
    } else if (x[j] != 0) {
      for (Eigen::Index r = 0; r < m; ++r) w_[r] -= problem.A(free_[static_cast<std::size_t>(r)], j) * x[j];
    }
  }
  for (Eigen::Index r = 0; r < m; ++r) {
    const double* const of = &problem.A(0, free_[static_cast<std::size_t>(r)]);
    double* const row = &factor_(0, r);  // stored as a column, so a row is contiguous
    double pivot = of[free_[static_cast<std::size_t>(r)]];
    for (Eigen::Index c = 0; c < r; ++c) {
      const double* const above = &factor_(0, c);
      double value = of[free_[static_cast<std::size_t>(c)]];
      for (Eigen::Index k = 0; k < c; ++k) value -= row[k] * above[k];
      row[c] = value;
    }
    for (Eigen::Index c = 0; c < r; ++c) {
      const double value = row[c];
      row[c] = value / factor_(c, c);
      pivot -= value * row[c];
      w_[r] -= row[c] * w_[c];
    }
    row[r] = pivot;
  }
  for (Eigen::Index r = m; r-- > 0;) {
    double value = w_[r] / factor_(r, r);
    for (Eigen::Index k = r + 1; k < m; ++k) value -= factor_(r, k) * solution_[k];
    solution_[r] = value;
  }
}

bool BoxLcp::Pivot(const Problem& problem, Eigen::VectorXd& x) {
  const Eigen::Index n = problem.rows();
  constexpr int kTries = 3;  // without progress
  Eigen::Index fewest = n + 1;
  for (int tries = kTries; tries > 0;) {
    SolveFree(problem, x);
    for (std::size_t r = 0; r < free_.size(); ++r) x[free_[r]] = solution_[static_cast<Eigen::Index>(r)];
    w_.noalias() = problem.A * x - problem.b;
    Eigen::Index wrong = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (problem.is_fixed(i)) continue;
      if (state(i) == State::kFree) {
        if (x[i] < problem.lower[i] - kSlack) {
          state(i) = State::kLower;
          ++wrong;
        } else if (x[i] > problem.upper[i] + kSlack) {
          state(i) = State::kUpper;
          ++wrong;
        }
      } else if (static_cast<int>(state(i)) * w_[i] > kWSlack) {
        state(i) = State::kFree;
        ++wrong;
      }
    }
    if (wrong == 0) return true;
    if (wrong < fewest) {
      fewest = wrong;
      tries = kTries;
    } else {
      --tries;
    }
  }
  return false;
}

bool BoxLcp::Descend(const Problem& problem, Eigen::VectorXd& x) {
  const Eigen::Index n = problem.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    x[i] = std::clamp(x[i], problem.lower[i], problem.upper[i]);
    state(i) = x[i] == problem.lower[i]   ? State::kLower
               : x[i] == problem.upper[i] ? State::kUpper
                                          : State::kFree;
  }
  for (Eigen::Index round = 0; round < 20 + 10 * n; ++round) {
    SolveFree(problem, x);
    // Move towards the solution as far as the bounds allow.
    double share = 1;
    Eigen::Index meets = -1;
    for (std::size_t r = 0; r < free_.size(); ++r) {
      const Eigen::Index i = free_[r];
      const double way = solution_[static_cast<Eigen::Index>(r)] - x[i];
      const double room = (way < 0 ? problem.lower[i] : problem.upper[i]) - x[i];
      if (std::abs(way) <= std::abs(room) || room / way >= share) continue;
      share = room / way;
      meets = i;
    }
    for (std::size_t r = 0; r < free_.size(); ++r) {
      double& value = x[free_[r]];
      value += share * (solution_[static_cast<Eigen::Index>(r)] - value);
    }
    if (meets >= 0) {
      state(meets) =
          x[meets] - problem.lower[meets] < problem.upper[meets] - x[meets] ? State::kLower : State::kUpper;
      continue;
    }
    w_.noalias() = problem.A * x - problem.b;
    double most = kWSlack;
    Eigen::Index worst = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (problem.is_fixed(i) || state(i) == State::kFree) continue;
      const double wrong = static_cast<int>(state(i)) * w_[i];
      if (wrong <= most) continue;
      most = wrong;
      worst = i;
    }
    if (worst < 0) return true;
    state(worst) = State::kFree;
  }
  return false;
}

}  // namespace coopdyn
