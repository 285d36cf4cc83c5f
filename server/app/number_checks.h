// SPDX-License-Identifier: MIT
// What options refuse that the parser takes for numbers: nan, inf, and what is out of range. Main thread.
#pragma once

#include <CLI/CLI.hpp>

namespace coopdyn {

/// A number from `least` to `most`.
CLI::Validator NumberIn(double least, double most);
/// A number above 0, at most `most`.
CLI::Validator NumberAbove0(double most);

}  // namespace coopdyn
