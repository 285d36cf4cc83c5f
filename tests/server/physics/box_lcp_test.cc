// SPDX-License-Identifier: MIT
#include "server/physics/box_lcp.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace coopdyn::lcp {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// The residual of `x`.
double Error(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper, const Eigen::VectorXd& x) {
  const Eigen::VectorXd w = A * x - b;
  double worst = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    worst = std::max({worst, lower[i] - x[i], x[i] - upper[i]});
    if (x[i] > lower[i]) worst = std::max(worst, w[i]);
    if (x[i] < upper[i]) worst = std::max(worst, -w[i]);
  }
  return worst;
}

TEST(BoxLcpTest, SolvesWhatIsNotBoundedAsLinearEquations) {
  Eigen::MatrixXd A(2, 2);
  A << 2, 1, 1, 3;
  const Eigen::Vector2d b(1, 2), lower(-kInf, -kInf), upper(kInf, kInf);
  Eigen::VectorXd x;
  ASSERT_TRUE(BoxLcp().Solve(A, b, lower, upper, x));
  EXPECT_LT((A * x - b).norm(), 1e-14);
}

TEST(BoxLcpTest, KeepsARowAtTheBoundThatItPushesAgainst) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::Vector2d b(-1, 3), lower(0, -2), upper(kInf, 2);
  Eigen::VectorXd x;
  ASSERT_TRUE(BoxLcp().Solve(A, b, lower, upper, x));
  EXPECT_EQ(x[0], 0);
  EXPECT_EQ(x[1], 2);
}

TEST(BoxLcpTest, SolvesRandomProblemsOfContactsThatShareTheirLoads) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  BoxLcp lcp;
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Index n = 3 + trial % 40, rank = 1 + trial % 12;
    // Fewer degrees of freedom than rows, as with standing legs: only the softness makes it definite.
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(n, rank, [&] { return normal(random); });
    Eigen::MatrixXd A = J * J.transpose();
    A.diagonal().array() += 1e-4;
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
    Eigen::VectorXd lower(n), upper(n), x;
    for (Eigen::Index i = 0; i < n; ++i) {
      upper[i] = i % 3 == 0 ? kInf : std::abs(normal(random));
      lower[i] = i % 3 == 0 ? 0 : -upper[i];
    }
    if (trial % 2 == 0) lcp.Forget();
    ASSERT_TRUE(lcp.Solve(A, b, lower, upper, x)) << trial;
    ASSERT_LT(Error(A, b, lower, upper, x), 1e-6) << trial;
  }
}

TEST(BoxLcpTest, ABeginElsewhereEndsAtTheSameSolution) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(12, 6, [&] { return normal(random); });
  Eigen::MatrixXd A = J * J.transpose();
  A.diagonal().array() += 1e-3;
  const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(12, [&] { return normal(random); });
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(12), most = Eigen::VectorXd::Constant(12, kInf);
  Eigen::VectorXd x, y;
  BoxLcp lcp;
  ASSERT_TRUE(lcp.Solve(A, b, zero, most, x));
  ASSERT_TRUE(lcp.Solve(A, -b, zero, most, y));
  ASSERT_TRUE(lcp.Solve(A, b, zero, most, y));
  EXPECT_LT((x - y).norm(), 1e-9);
}

}  // namespace
}  // namespace coopdyn::lcp
