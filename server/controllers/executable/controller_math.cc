// SPDX-License-Identifier: MIT
// The math functions of clients/plugin/controller.h, linked into every program that loads controllers.
#include "clients/plugin/controller.h"

#include <cmath>

#include "server/base/portable_loaded.h"
#include "server/base/portable_math.h"

namespace portable = coopdyn::portable;

double coopdyn_sin(double x) {
  return portable::Sin(x);
}
double coopdyn_cos(double x) {
  return portable::Cos(x);
}
double coopdyn_tan(double x) {
  return portable::Tan(x);
}
double coopdyn_asin(double x) {
  return portable::Asin(x);
}
double coopdyn_acos(double x) {
  return portable::Acos(x);
}
double coopdyn_atan(double x) {
  return portable::Atan(x);
}
double coopdyn_exp(double x) {
  return portable::Exp(x);
}
double coopdyn_ln(double x) {
  return portable::Log(x);
}
double coopdyn_cbrt(double x) {
  return portable::Cbrt(x);
}
double coopdyn_sinh(double x) {
  return portable::Sinh(x);
}
double coopdyn_cosh(double x) {
  return portable::Cosh(x);
}
double coopdyn_tanh(double x) {
  return portable::Tanh(x);
}
double coopdyn_exp2(double x) {
  return portable::Exp2(x);
}
double coopdyn_exp10(double x) {
  return portable::Exp10(x);
}
double coopdyn_expm1(double x) {
  return portable::Expm1(x);
}
double coopdyn_log2(double x) {
  return portable::Log2(x);
}
double coopdyn_log10(double x) {
  return portable::Log10(x);
}
double coopdyn_log1p(double x) {
  return portable::Log1p(x);
}
double coopdyn_atan2(double y, double x) {
  return portable::Atan2(y, x);
}
double coopdyn_pow(double x, double y) {
  return portable::Pow(x, y);
}
double coopdyn_hypot(double x, double y) {
  return ::hypot(x, y);  // from libm_symbols.cc, for numbers of any size
}
void coopdyn_sincos(double x, double* sine, double* cosine) {
  const auto [sin, cos] = portable::SinCos(x);
  *sine = sin;
  *cosine = cos;
}
