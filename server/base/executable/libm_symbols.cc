// SPDX-License-Identifier: MIT
// Part of every coopdyn program that links coopdyn_base. Its symbols precede libm's in lookup order, so that
// results of libraries between a file and the hash (libsdformat's poses, libassimp's nodes, ODE's joints)
// have the same bits on every machine, too.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/portable_loaded.h"
#include "server/base/portable_math.h"

namespace portable = coopdyn::portable;

extern "C" {

double sin(double x) noexcept {
  return portable::Sin(x);
}
double cos(double x) noexcept {
  return portable::Cos(x);
}
double tan(double x) noexcept {
  return portable::Tan(x);
}
double asin(double x) noexcept {
  return portable::Asin(x);
}
double acos(double x) noexcept {
  return portable::Acos(x);
}
double atan(double x) noexcept {
  return portable::Atan(x);
}
double exp(double x) noexcept {
  return portable::Exp(x);
}
double log(double x) noexcept {
  return portable::Log(x);
}
double cbrt(double x) noexcept {
  return portable::Cbrt(x);
}
double sinh(double x) noexcept {
  return portable::Sinh(x);
}
double cosh(double x) noexcept {
  return portable::Cosh(x);
}
double tanh(double x) noexcept {
  return portable::Tanh(x);
}
double exp2(double x) noexcept {
  return portable::Exp2(x);
}
double exp10(double x) noexcept {
  return portable::Exp10(x);
}
double expm1(double x) noexcept {
  return portable::Expm1(x);
}
double log2(double x) noexcept {
  return portable::Log2(x);
}
double log10(double x) noexcept {
  return portable::Log10(x);
}
double log1p(double x) noexcept {
  return portable::Log1p(x);
}
double atan2(double x, double y) noexcept {
  return portable::Atan2(x, y);
}
double pow(double x, double y) noexcept {
  return portable::Pow(x, y);
}
/// Accepts all numbers, like libm's: scales by a power of two where squares would overflow or underflow.
double hypot(double x, double y) noexcept {
  const double most = std::max(std::abs(x), std::abs(y));
  if (std::isinf(x) || std::isinf(y)) return std::numeric_limits<double>::infinity();
  const double scale = most > 1e150 ? 0x1p-600 : most < 1e-140 ? 0x1p600 : 1;
  return portable::Hypot(x * scale, y * scale) / scale;
}
void sincos(double x, double* sine, double* cosine) noexcept {
  const auto [sin, cos] = portable::SinCos(x);
  *sine = sin;
  *cosine = cos;
}

float sinf(float x) noexcept {
  return static_cast<float>(portable::Sin(x));
}
float cosf(float x) noexcept {
  return static_cast<float>(portable::Cos(x));
}
float tanf(float x) noexcept {
  return static_cast<float>(portable::Tan(x));
}
float asinf(float x) noexcept {
  return static_cast<float>(portable::Asin(x));
}
float acosf(float x) noexcept {
  return static_cast<float>(portable::Acos(x));
}
float atanf(float x) noexcept {
  return static_cast<float>(portable::Atan(x));
}
float expf(float x) noexcept {
  return static_cast<float>(portable::Exp(x));
}
float logf(float x) noexcept {
  return static_cast<float>(portable::Log(x));
}
float cbrtf(float x) noexcept {
  return static_cast<float>(portable::Cbrt(x));
}
float sinhf(float x) noexcept {
  return static_cast<float>(portable::Sinh(x));
}
float coshf(float x) noexcept {
  return static_cast<float>(portable::Cosh(x));
}
float tanhf(float x) noexcept {
  return static_cast<float>(portable::Tanh(x));
}
float exp2f(float x) noexcept {
  return static_cast<float>(portable::Exp2(x));
}
float exp10f(float x) noexcept {
  return static_cast<float>(portable::Exp10(x));
}
float expm1f(float x) noexcept {
  return static_cast<float>(portable::Expm1(x));
}
float log2f(float x) noexcept {
  return static_cast<float>(portable::Log2(x));
}
float log10f(float x) noexcept {
  return static_cast<float>(portable::Log10(x));
}
float log1pf(float x) noexcept {
  return static_cast<float>(portable::Log1p(x));
}
float atan2f(float x, float y) noexcept {
  return static_cast<float>(portable::Atan2(x, y));
}
float powf(float x, float y) noexcept {
  return static_cast<float>(portable::Pow(x, y));
}
float hypotf(float x, float y) noexcept {
  return static_cast<float>(portable::Hypot(x, y));
}
void sincosf(float x, float* sine, float* cosine) noexcept {
  const auto [sin, cos] = portable::SinCos(x);
  *sine = static_cast<float>(sin);
  *cosine = static_cast<float>(cos);
}

}  // extern "C"
