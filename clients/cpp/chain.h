// SPDX-License-Identifier: MIT
// Forward and inverse kinematics of a serial chain of joints. Needs no daemon.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn::client {

/// A joint in the base frame, with all joints at 0: a point on its axis [m] and the axis' direction. Limits
/// in rad; in m for a slider.
struct ChainJoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  bool slider = false;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// A serial chain from a base to a tool, as product of exponentials: X(q) = exp([S1] q1) ... exp([Sn] qn)
/// X(0) (Lynch and Park, Modern Robotics, 4.1). Joints::get_chain() returns that of a robot's arm.
class Chain {
 public:
  /// `tool`: the tool's pose with all joints at 0. Throws Error 4 if an axis has no direction.
  Chain(std::vector<ChainJoint> joints, const Eigen::Isometry3d& tool);

  const std::vector<ChainJoint>& joints() const { return joints_; }

  /// The tool's pose in the base frame, with the joints at q [rad, m].
  Eigen::Isometry3d forward(const std::vector<double>& q) const;
  /// Returns a posture within the limits that brings the tool to a pose, or (below) only to a position [m]:
  /// the first found, starting at q0 (empty: the middle of the limits). Throws Error 4 if none is found.
  /// Damped least squares on the chain's Jacobian, restarted at random postures, the same on each call.
  std::vector<double> inverse(const Eigen::Isometry3d& pose, const std::vector<double>& q0 = {}) const;
  std::vector<double> inverse(const Eigen::Vector3d& position, const std::vector<double>& q0 = {}) const;

 private:
  struct Target {
    std::optional<Eigen::Matrix3d> R;
    Eigen::Vector3d p;
  };
  struct State {
    Eigen::Isometry3d tool;
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;  // of the tool's position and rotation
  };

  void RequirePosture(const std::vector<double>& q, const std::string& what) const;
  State At(const Eigen::VectorXd& q) const;
  Eigen::VectorXd Error6(const Target& target, const Eigen::Isometry3d& tool) const;
  /// Moves q to a local minimum of the error, and returns that error.
  Eigen::VectorXd Descend(const Target& target, Eigen::VectorXd& q) const;
  std::vector<double> Find(const Target& target, const std::vector<double>& q0) const;

  std::vector<ChainJoint> joints_;
  Eigen::Isometry3d tool_;
  Eigen::VectorXd lower_, upper_;
};

}  // namespace coopdyn::client
