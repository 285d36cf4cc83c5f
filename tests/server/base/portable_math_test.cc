// SPDX-License-Identifier: MIT
#include "server/base/portable_math.h"
#include "server/base/portable_loaded.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "server/base/random.h"

namespace coopdyn {
namespace {

/// With a long double of 64 bits, libm's result is correct to our last bit except for ties.
double UlpsOff(double value, long double exact) {
  const double nearest = static_cast<double>(exact);
  const double ulp =
      std::nextafter(std::abs(nearest), std::numeric_limits<double>::infinity()) - std::abs(nearest);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact)) / ulp;
}

struct Function {
  const char* name;
  std::function<double(double)> ours;
  std::function<long double(long double)> exact;
  double least, most;
};

TEST(PortableMathTest, EachFunctionIsWithinOneUlp) {
  using L = long double;
  const Function functions[] = {{"sin", portable::Sin, [](L x) { return std::sin(x); }, -100, 100},
                                {"cos", portable::Cos, [](L x) { return std::cos(x); }, -100, 100},
                                {"sin of both", [](double x) { return portable::SinCos(x).sin; },
                                 [](L x) { return std::sin(x); }, -100, 100},
                                {"cos of both", [](double x) { return portable::SinCos(x).cos; },
                                 [](L x) { return std::cos(x); }, -100, 100},
                                {"tan", portable::Tan, [](L x) { return std::tan(x); }, -1.5, 1.5},
                                {"asin", portable::Asin, [](L x) { return std::asin(x); }, -1, 1},
                                {"acos", portable::Acos, [](L x) { return std::acos(x); }, -1, 1},
                                {"atan", portable::Atan, [](L x) { return std::atan(x); }, -50, 50},
                                {"atan2", [](double x) { return portable::Atan2(x, -2); },
                                 [](L x) { return std::atan2(x, L(-2)); }, -9, 9},
                                {"exp", portable::Exp, [](L x) { return std::exp(x); }, -700, 700},
                                {"log", portable::Log, [](L x) { return std::log(x); }, 1e-9, 1e3},
                                {"pow", [](double x) { return portable::Pow(x, 2.5); },
                                 [](L x) { return std::pow(x, L(2.5)); }, 0, 1e3},
                                {"cbrt", portable::Cbrt, [](L x) { return std::cbrt(x); }, -1e3, 1e3},
                                {"sinh", portable::Sinh, [](L x) { return std::sinh(x); }, -700, 700},
                                {"cosh", portable::Cosh, [](L x) { return std::cosh(x); }, -700, 700},
                                {"tanh", portable::Tanh, [](L x) { return std::tanh(x); }, -20, 20},
                                {"exp2", portable::Exp2, [](L x) { return std::exp2(x); }, -1000, 1000},
                                {"exp10", portable::Exp10, [](L x) { return std::pow(L(10), x); }, -300, 300},
                                {"expm1", portable::Expm1, [](L x) { return std::expm1(x); }, -30, 30},
                                {"log2", portable::Log2, [](L x) { return std::log2(x); }, 1e-09, 1000.0},
                                {"log10", portable::Log10, [](L x) { return std::log10(x); }, 1e-09, 1000.0},
                                {"log1p", portable::Log1p, [](L x) { return std::log1p(x); }, -0.99, 1000.0},
                                {"hypot", [](double x) { return portable::Hypot(x, 3); },
                                 [](L x) { return std::hypot(x, L(3)); }, -9, 9}};
  for (const Function& each : functions) {
    RandomNumbers random(7);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
      const double x = each.least + (each.most - each.least) * random.Next();
      worst = std::max(worst, UlpsOff(each.ours(x), each.exact(x)));
    }
    EXPECT_LE(worst, 1.0) << each.name;
  }
}

TEST(PortableMathTest, TheBitsAreTheseOnEveryMachine) {
  std::uint64_t state = 0;
  RandomNumbers random(1);
  for (int i = 0; i < 1000; ++i) {
    const double x = 20 * random.Next() - 10, part = x / 10, y = random.Next();
    for (const double value :
         {portable::Sin(x),      portable::Cos(x),
          portable::Tan(x),      portable::Asin(part),
          portable::Acos(part),  portable::Atan(x),
          portable::Atan2(x, y), portable::Exp(x),
          portable::Log(y),      portable::Pow(y, x),
          portable::Cbrt(x),     portable::Hypot(x, y),
          portable::Sinh(x),     portable::Cosh(x),
          portable::Tanh(x),     portable::Exp2(x),
          portable::Exp10(x),    portable::Expm1(x),
          portable::Log2(y),     portable::Log10(y),
          portable::Log1p(y),    NormalOf(UniformOf(MixBits(static_cast<std::uint64_t>(i) + 1)), y)})
      state = AbsorbBits(state, std::bit_cast<std::uint64_t>(value));
  }
  EXPECT_EQ(state, 3756760741608005362u);
}

TEST(PortableMathTest, WhatALibraryCallsIsOurs) {
  RandomNumbers random(3);
  for (int i = 0; i < 10000; ++i) {
    const volatile double x = 20 * random.Next() - 10;
    ASSERT_EQ(std::sin(x), portable::Sin(x));
    ASSERT_EQ(std::cos(x),
              portable::Cos(x));  // the compiler may merge this with the line above into one sincos()
    ASSERT_EQ(portable::SinCos(x).sin, portable::Sin(x));
    ASSERT_EQ(portable::SinCos(x).cos, portable::Cos(x));
    ASSERT_EQ(std::atan2(x, 3.0), portable::Atan2(x, 3));
    ASSERT_EQ(std::exp(x), portable::Exp(x));
    ASSERT_EQ(std::pow(2.5, x), portable::Pow(2.5, x));
    ASSERT_EQ(std::tanh(x), portable::Tanh(x));
    ASSERT_EQ(std::expm1(x), portable::Expm1(x));
    ASSERT_EQ(std::log10(x * x), portable::Log10(x * x));
    ASSERT_EQ(std::tanh(static_cast<float>(x)), static_cast<float>(portable::Tanh(static_cast<float>(x))));
  }
}

TEST(PortableMathTest, TheLengthThatALibraryAsksForIsRightForEachNumber) {
  constexpr double kInf = std::numeric_limits<double>::infinity(),
                   kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double size :
       {5e-324, 3e-320, 2e-308, 1e-300, 1e-200, 1e-155, 1e-139, 1.0, 1e149, 1e151, 1e200, 5e307}) {
    const volatile double x = size, y = 0.75 * size;
    const auto exact = std::hypot(static_cast<long double>(x), static_cast<long double>(y));
    EXPECT_LE(UlpsOff(std::hypot(x, y), exact), 1.0) << size;
    EXPECT_EQ(std::hypot(-x, 0.0), size);
  }
  volatile double infinite = -kInf, none = kNan;
  EXPECT_EQ(std::hypot(infinite, none), kInf);
  EXPECT_EQ(std::hypot(none, infinite), kInf);
  EXPECT_TRUE(std::isnan(std::hypot(none, 1e300)));
  EXPECT_TRUE(std::isnan(std::hypot(1.0, none)));
}

TEST(PortableMathTest, SpecialValuesAreThoseOfTheStandard) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(portable::Sin(0), 0);
  EXPECT_EQ(portable::Cos(0), 1);
  EXPECT_EQ(portable::Atan2(0, -1), std::numbers::pi);
  EXPECT_EQ(portable::Atan2(0, 0), 0);
  EXPECT_EQ(portable::Exp(-kInf), 0);
  EXPECT_EQ(portable::Log(0), -kInf);
  EXPECT_EQ(portable::Hypot(3, -4), 5);
  EXPECT_EQ(portable::Acos(-1), std::numbers::pi);
  EXPECT_EQ(portable::Tanh(kInf), 1);
  EXPECT_EQ(portable::Exp2(10), 1024);
  EXPECT_EQ(portable::Exp10(2), 100);
  EXPECT_EQ(portable::Log2(8), 3);
  EXPECT_EQ(portable::Log10(1000), 3);
  EXPECT_TRUE(std::isnan(portable::Sin(kInf)));
  EXPECT_TRUE(std::isnan(portable::Acos(2)));
}

TEST(PortableMathTest, ARotationIsThatOfEigen) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  EXPECT_TRUE(
      portable::AngleAxis(0.7, axis).isApprox(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, axis)), 1e-15));
}

}  // namespace
}  // namespace coopdyn
