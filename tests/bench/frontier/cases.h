// SPDX-License-Identifier: MIT
// Motions whose end is known from mechanics, and an engine's deviation from it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/frontier/engine.h"

namespace coopdyn::frontier {

/// All bodies at the start and after each kSample_s.
using Film = std::vector<std::vector<Motion>>;
inline constexpr double kSample_s = 0.01;

struct Case {
  std::string name, title;
  std::string unit;  // of the error
  double floor = 0;  // negligible error: smaller ones count as equal
  double duration_s = 0;
  Setup setup;
  std::function<double(const Film&)> error;
};

std::vector<Case> Cases();

}  // namespace coopdyn::frontier
