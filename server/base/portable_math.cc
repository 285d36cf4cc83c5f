// SPDX-License-Identifier: MIT
#include "server/base/portable_math.h"

#include <sleef.h>  // 4,000 lines of vector types: include it nowhere else

#include "server/base/portable_loaded.h"

namespace coopdyn::portable {

// A compiler may merge calls of sin() and cos() into one of sincos(), so all three must give the same bits.
double Sin(double x) {
  return SinCos(x).sin;
}

double Cos(double x) {
  return SinCos(x).cos;
}

SineCosine SinCos(double x) {
  const Sleef_double_2 both = Sleef_cinz_sincosd1_u10purec(x);
  return {both.x, both.y};
}

double Tan(double x) {
  return Sleef_cinz_tand1_u10purec(x);
}

double Asin(double x) {
  return Sleef_cinz_asind1_u10purec(x);
}

double Acos(double x) {
  return Sleef_cinz_acosd1_u10purec(x);
}

double Atan(double x) {
  return Sleef_cinz_atand1_u10purec(x);
}

double Atan2(double y, double x) {
  return Sleef_cinz_atan2d1_u10purec(y, x);
}

double Exp(double x) {
  return Sleef_cinz_expd1_u10purec(x);
}

double Log(double x) {
  return Sleef_cinz_logd1_u10purec(x);
}

double Pow(double x, double y) {
  return Sleef_cinz_powd1_u10purec(x, y);
}

double Cbrt(double x) {
  return Sleef_cinz_cbrtd1_u10purec(x);
}

double Sinh(double x) {
  return Sleef_cinz_sinhd1_u10purec(x);
}

double Cosh(double x) {
  return Sleef_cinz_coshd1_u10purec(x);
}

double Tanh(double x) {
  return Sleef_cinz_tanhd1_u10purec(x);
}

double Exp2(double x) {
  return Sleef_cinz_exp2d1_u10purec(x);
}

double Exp10(double x) {
  return Sleef_cinz_exp10d1_u10purec(x);
}

double Expm1(double x) {
  return Sleef_cinz_expm1d1_u10purec(x);
}

double Log2(double x) {
  return Sleef_cinz_log2d1_u10purec(x);
}

double Log10(double x) {
  return Sleef_cinz_log10d1_u10purec(x);
}

double Log1p(double x) {
  return Sleef_cinz_log1pd1_u10purec(x);
}

Eigen::Quaterniond AngleAxis(double angle_rad, const Eigen::Vector3d& axis) {
  const auto [sin, cos] = SinCos(angle_rad / 2);
  Eigen::Quaterniond q;
  q.w() = cos;
  q.vec() = sin * axis;
  return q;
}

}  // namespace coopdyn::portable
