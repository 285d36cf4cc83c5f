// SPDX-License-Identifier: MIT
// Hill-type muscles: parameters, length factor and velocity factor. Immutable once read; pure.
#pragma once

#include <Eigen/Core>

namespace coopdyn {

/// Pulls two points together with activation · max_force · length factor · velocity factor.
struct MuscleModel {
  Eigen::Vector3d p_from_R = Eigen::Vector3d::Zero(),
                  p_to_R = Eigen::Vector3d::Zero();  // in the initial pose
  double max_force_n = 0;
  double optimal_length_m = 0;
  double width = 0.56;       // of the bell curve of the length factor, in optimal lengths
  double c = 2.99573227355;  // −ln of the length factor at the bell's edge
  double max_velocity_m_s = 0;
  double eccentric = 1.5;                       // N: velocity factor of fast lengthening
  double curvature = 5;                         // K of the hyperbola
  bool use_length = true, use_velocity = true;  // false: the factor is 1
};

/// exp(−c |(l − l_opt) / (width l_opt)|³).
double LengthFactor(const MuscleModel& muscle, double length_m);

/// The velocity factor at a shortening speed (negative: lengthening), and its slope, which is at most 0.
struct VelocityFactor {
  double value = 1, slope = 0;
};
VelocityFactor VelocityFactorOf(const MuscleModel& muscle, double shortening_m_s);

}  // namespace coopdyn
