// SPDX-License-Identifier: MIT
#include "clients/cpp/chain.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <utility>

#include "clients/cpp/error.h"

namespace coopdyn::client {
namespace {

constexpr int kStarts = 30, kRounds = 100;
/// Errors [m, rad] at which the search stops, and which it accepts.
constexpr double kExact = 1e-10, kReached = 1e-7;
constexpr double kLeastDamping = 1e-12;
constexpr double kLongestStep = 0.7;  // [rad, m]

}  // namespace

Chain::Chain(std::vector<ChainJoint> joints, const Eigen::Isometry3d& tool)
    : joints_(std::move(joints)),
      tool_(tool),
      lower_(static_cast<Eigen::Index>(joints_.size())),
      upper_(static_cast<Eigen::Index>(joints_.size())) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const double length = joints_[i].axis.norm();
    if (!(length > 0) || !std::isfinite(length))
      throw Error(4, "an axis is a direction: its length is not 0");
    joints_[i].axis /= length;
    lower_[static_cast<Eigen::Index>(i)] = joints_[i].lower;
    upper_[static_cast<Eigen::Index>(i)] = joints_[i].upper;
  }
}

Eigen::Isometry3d Chain::forward(const std::vector<double>& q) const {
  RequirePosture(q, "q");
  return At(Eigen::VectorXd::Map(q.data(), lower_.size())).tool;
}

std::vector<double> Chain::inverse(const Eigen::Isometry3d& pose, const std::vector<double>& q0) const {
  return Find({pose.linear(), pose.translation()}, q0);
}

std::vector<double> Chain::inverse(const Eigen::Vector3d& position, const std::vector<double>& q0) const {
  return Find({std::nullopt, position}, q0);
}

void Chain::RequirePosture(const std::vector<double>& q, const std::string& what) const {
  if (q.size() != joints_.size())
    throw Error(3, what + " has " + std::to_string(q.size()) + " values, the chain " +
                       std::to_string(joints_.size()) + " joints");
  if (!std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); }))
    throw Error(4, "the values of " + what + " must be finite");
}

Chain::State Chain::At(const Eigen::VectorXd& q) const {
  const Eigen::Index n = q.size();
  State state{Eigen::Isometry3d::Identity(), {}};
  state.jacobian.setZero(6, n);
  Eigen::Matrix3Xd points(3, n);
  Eigen::Isometry3d& X = state.tool;
  for (Eigen::Index i = 0; i < n; ++i) {
    const ChainJoint& joint = joints_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis = X.linear() * joint.axis;
    points.col(i) = X * joint.point;
    state.jacobian.col(i).segment<3>(joint.slider ? 0 : 3) = axis;
    if (joint.slider) {
      X.translation() += axis * q[i];
    } else {
      X.linear() *= Eigen::AngleAxisd(q[i], joint.axis).toRotationMatrix();
      X.translation() = points.col(i) - X.linear() * joint.point;
    }
  }
  X = X * tool_;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (joints_[static_cast<std::size_t>(i)].slider) continue;
    const Eigen::Vector3d axis = state.jacobian.col(i).tail<3>();
    state.jacobian.col(i).head<3>() = axis.cross(X.translation() - points.col(i));
  }
  return state;
}

Eigen::VectorXd Chain::Error6(const Target& target, const Eigen::Isometry3d& tool) const {
  Eigen::VectorXd error(target.R ? 6 : 3);
  error.head<3>() = target.p - tool.translation();
  if (target.R) {
    const Eigen::AngleAxisd turn(Eigen::Quaterniond(*target.R * tool.linear().transpose()));
    const double angle = turn.angle() > std::numbers::pi ? turn.angle() - 2 * std::numbers::pi : turn.angle();
    error.tail<3>() = turn.axis() * angle;
  }
  return error;
}

Eigen::VectorXd Chain::Descend(const Target& target, Eigen::VectorXd& q) const {
  Eigen::VectorXd error;
  for (int round = 0; round < kRounds; ++round) {
    const State state = At(q);
    error = Error6(target, state.tool);
    if (error.norm() < kExact) break;
    Eigen::MatrixXd J = state.jacobian.topRows(error.size());
    const Eigen::VectorXd slope = J.transpose() * error;
    for (Eigen::Index i = 0; i < q.size(); ++i) {  // freeze joints that would leave their limits
      if ((q[i] >= upper_[i] && slope[i] > 0) || (q[i] <= lower_[i] && slope[i] < 0)) J.col(i).setZero();
    }
    Eigen::MatrixXd A = J * J.transpose();
    A.diagonal().array() += error.squaredNorm() / 2 + kLeastDamping;
    const Eigen::VectorXd step = J.transpose() * A.llt().solve(error);
    const double longest = step.size() > 0 ? step.lpNorm<Eigen::Infinity>() : 0;
    if (longest < 1e-14) break;
    q = (q + std::min(1.0, kLongestStep / longest) * step).cwiseMax(lower_).cwiseMin(upper_);
  }
  return error;
}

std::vector<double> Chain::Find(const Target& target, const std::vector<double>& q0) const {
  if (!target.p.allFinite() || (target.R && !target.R->allFinite()))
    throw Error(4, "the values of a pose must be finite");
  if (target.R && (!target.R->isUnitary(1e-6) || target.R->determinant() < 0))
    throw Error(4, "the rotation of a pose must be one: its columns at right angles and of length 1");
  if (!q0.empty()) RequirePosture(q0, "q0");
  constexpr double kPi = std::numbers::pi;
  const Eigen::VectorXd low =
      lower_.array().isFinite().select(lower_.array(), (upper_.array() - 1).min(-kPi));
  const Eigen::VectorXd high = upper_.array().isFinite().select(upper_.array(), (low.array() + 1).max(kPi));
  Eigen::VectorXd start = (low + high) / 2;
  if (!q0.empty()) start = Eigen::VectorXd::Map(q0.data(), lower_.size());
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(6, std::numeric_limits<double>::infinity());
  std::uint32_t dice = 1;
  for (int i = 0; i < kStarts; ++i) {
    Eigen::VectorXd q = start.cwiseMax(lower_).cwiseMin(upper_);
    const Eigen::VectorXd error = Descend(target, q);
    if (error.norm() < kReached) return {q.begin(), q.end()};
    if (error.norm() < nearest.norm()) nearest = error;
    for (Eigen::Index k = 0; k < start.size(); ++k) {
      dice = 1664525U * dice + 1013904223U;
      start[k] = low[k] + (high[k] - low[k]) * dice / 4294967296.0;
    }
  }
  std::ostringstream text;
  text.precision(3);
  text << "no posture within the limits was found that brings the tool there: the nearest is "
       << nearest.head<3>().norm() << " m";
  if (target.R) text << " and " << nearest.tail<3>().norm() << " rad";
  text << " off; choose a pose within reach, or give only a position x, y, z";
  throw Error(4, text.str());
}

}  // namespace coopdyn::client
