// SPDX-License-Identifier: MIT
// The functions of controller.h at and beyond the ends of their ranges.
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "clients/plugin/controller.h"

namespace coopdyn {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity(), kMost = std::numeric_limits<double>::max(),
                 kLeast = 5e-324;
using L = long double;

/// Equals libm's 64-bit result to 1 ulp, including infinities, signs of zero and NaN.
void ExpectNear(double ours, L exact, const std::string& what) {
  const auto nearest = static_cast<double>(exact);
  if (std::isnan(nearest)) {
    EXPECT_TRUE(std::isnan(ours)) << what << ": " << ours;
  } else if (std::isinf(nearest) || nearest == 0) {
    EXPECT_EQ(ours, nearest) << what;
    EXPECT_EQ(std::signbit(ours), std::signbit(nearest)) << what;
  } else {
    const double ulp = std::nextafter(std::abs(nearest), kInf) - std::abs(nearest);
    EXPECT_LE(std::abs(ours - exact), ulp) << what << ": " << ours << ", not " << nearest;
  }
}

const double kNumbers[] = {0.0,
                           -0.0,
                           kInf,
                           -kInf,
                           std::nan(""),
                           kLeast,
                           -kLeast,
                           1e-310,
                           2.3e-308,
                           -1e-200,
                           1e-8,
                           0.5,
                           1,
                           -1,
                           1 + 3e-16,
                           1 - 2e-16,
                           1.5707963267948966,
                           3.141592653589793,
                           -7,
                           27,
                           709.7,
                           710,
                           -745,
                           -746,
                           1e16,
                           1e22,
                           1e200,
                           -1e300,
                           kMost,
                           -kMost};

TEST(ControllerFunctionsTest, OfOneNumber) {
  const struct {
    const char* name;
    double (*ours)(double);
    L (*exact)(L);
  } functions[] = {{"sin", coopdyn_sin, std::sin},    {"cos", coopdyn_cos, std::cos},
                   {"tan", coopdyn_tan, std::tan},    {"asin", coopdyn_asin, std::asin},
                   {"acos", coopdyn_acos, std::acos}, {"atan", coopdyn_atan, std::atan},
                   {"exp", coopdyn_exp, std::exp},    {"ln", coopdyn_ln, std::log},
                   {"cbrt", coopdyn_cbrt, std::cbrt}};
  for (const double x : kNumbers) {
    for (const auto& [name, ours, exact] : functions)
      ExpectNear(ours(x), exact(x), name + (" of " + std::to_string(x)));
    double sine = 0, cosine = 0;
    coopdyn_sincos(x, &sine, &cosine);
    ExpectNear(sine, std::sin(L(x)), "sine of both");
    ExpectNear(cosine, std::cos(L(x)), "cosine of both");
  }
}

TEST(ControllerFunctionsTest, OfTwoNumbers) {
  for (const double x : kNumbers) {
    for (const double y : kNumbers) {
      const std::string what = " of " + std::to_string(x) + ", " + std::to_string(y);
      ExpectNear(coopdyn_hypot(x, y), std::hypot(L(x), L(y)), "hypot" + what);
      ExpectNear(coopdyn_atan2(y, x), std::atan2(L(y), L(x)), "atan2" + what);
      // SLEEF's largest result is already infinite.
      if (std::abs(x) != kMost) ExpectNear(coopdyn_pow(x, y), std::pow(L(x), L(y)), "pow" + what);
    }
  }
}

}  // namespace
}  // namespace coopdyn
