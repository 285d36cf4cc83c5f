// SPDX-License-Identifier: MIT
// The transcendental functions of all that a run's hash depends on: the same bits on every machine. libm's
// are not, as it chooses them by the processor and improves them with its versions. SLEEF's deterministic
// functions, scalar and without FMA, within 1 ulp (N. Shibata, F. Petrogalli: SLEEF, IEEE TPDS 2020). sqrt,
// floor, fmod and remainder are exact by IEEE 754 and need no other. Pure; any thread. Angles in radians.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace coopdyn::portable {

struct SineCosine {
  double sin = 0, cos = 1;
};

double Sin(double x);
double Cos(double x);
/// Both, for the price of one.
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
/// Neither x nor y above 1e150: nothing here is, and a plain root is a fifth of SLEEF's.
inline double Hypot(double x, double y) {
  return std::sqrt(x * x + y * y);
}
/// The rotation about `axis`, of length 1. Eigen's own has libm's sine.
Eigen::Quaterniond AngleAxis(double angle_rad, const Eigen::Vector3d& axis);

}  // namespace coopdyn::portable
