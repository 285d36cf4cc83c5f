// SPDX-License-Identifier: MIT
// Transcendental functions for everything that a run's hash depends on: the same bits on every machine.
// libm's results vary, because libm selects implementations by processor and changes them between versions.
// These are SLEEF's deterministic functions, scalar and without FMA, within 1 ulp (N. Shibata, F. Petrogalli:
// SLEEF, IEEE TPDS 2020). IEEE 754 makes sqrt, floor, fmod and remainder exact; use libm's. Pure; any thread.
// Angles in radians.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace coopdyn::portable {

struct SineCosine {
  double sin = 0, cos = 1;
};

double Sin(double x);
double Cos(double x);
/// Sine and cosine at the cost of one.
SineCosine SinCos(double x);
double Tan(double x);
double Asin(double x);
double Acos(double x);
double Atan(double x);
double Atan2(double y, double x);
double Exp(double x);
double Log(double x);
double Pow(double x, double y);
double Cbrt(double x);
/// @pre neither |x| nor |y| above 1e150. A plain root takes a fifth of the time of SLEEF's hypot.
inline double Hypot(double x, double y) {
  return std::sqrt(x * x + y * y);
}
/// The rotation about `axis`, a unit vector. Eigen's AngleAxis uses libm's sine.
Eigen::Quaterniond AngleAxis(double angle_rad, const Eigen::Vector3d& axis);

}  // namespace coopdyn::portable
