// SPDX-License-Identifier: MIT
#include "server/physics/box_lcp.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace coopdyn {

bool BoxLcp::Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
  const Eigen::Index n = b.size();
  x.setZero(n);
  states_.assign(static_cast<std::size_t>(n), State::kFree);
  const double x_slack = 1e-9, w_slack = 1e-10;
  constexpr int kBlockTries = 4;
  Eigen::Index fewest = n + 1;
  int tries = kBlockTries;
  for (Eigen::Index round = 0; round < 20 + 5 * n; ++round) {
    free_.clear();
    for (Eigen::Index i = 0; i < n; ++i) {
      const State state = states_[static_cast<std::size_t>(i)];
      if (state == State::kFree && lower[i] < upper[i]) {
        free_.push_back(i);
      } else {
        x[i] = state == State::kUpper ? upper[i] : state == State::kLower ? lower[i] : 0;
      }
    }
    const Eigen::Index m = static_cast<Eigen::Index>(free_.size());
    part_.resize(m, m);
    rest_.resize(m);
    for (Eigen::Index r = 0; r < m; ++r) {
      const Eigen::Index i = free_[static_cast<std::size_t>(r)];
      double sum = b[i];
      for (Eigen::Index j = 0; j < n; ++j) {
        const bool is_free = states_[static_cast<std::size_t>(j)] == State::kFree && lower[j] < upper[j];
        if (!is_free) sum -= A(j, i) * x[j];
      }
      rest_[r] = sum;
      for (Eigen::Index c = 0; c <= r; ++c) part_(r, c) = A(i, free_[static_cast<std::size_t>(c)]);
    }
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(part_);
    llt.solveInPlace(rest_);
    for (Eigen::Index r = 0; r < m; ++r) x[free_[static_cast<std::size_t>(r)]] = rest_[r];
    w_.noalias() = A * x;
    w_ -= b;
    wrong_.clear();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!(lower[i] < upper[i])) continue;
      const State state = states_[static_cast<std::size_t>(i)];
      const bool is_wrong = state == State::kFree    ? x[i] < lower[i] - x_slack || x[i] > upper[i] + x_slack
                            : state == State::kLower ? w_[i] < -w_slack
                                                     : w_[i] > w_slack;
      if (is_wrong) wrong_.push_back(i);
    }
    if (wrong_.empty()) {
      for (Eigen::Index i = 0; i < n; ++i) x[i] = std::min(std::max(x[i], lower[i]), upper[i]);
      return true;
    }
    const auto switch_state = [&](Eigen::Index i) {
      State& state = states_[static_cast<std::size_t>(i)];
      state = state != State::kFree ? State::kFree : x[i] < lower[i] ? State::kLower : State::kUpper;
    };
    const Eigen::Index count = static_cast<Eigen::Index>(wrong_.size());
    if (count < fewest) {
      fewest = count;
      tries = kBlockTries;
    } else {
      --tries;
    }
    if (tries >= 0) {
      for (const Eigen::Index i : wrong_) switch_state(i);
    } else {
      switch_state(wrong_.back());
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) x[i] = std::min(std::max(x[i], lower[i]), upper[i]);
  return false;
}

}  // namespace coopdyn
