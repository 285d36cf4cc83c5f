// SPDX-License-Identifier: MIT
// Numbers, units and words as people write them in files. Pure functions; any thread; independent of the
// locale.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/words.h"

namespace coopdyn {

/// What a number measures: which units may stand right behind it.
enum class Quantity { kPlain, kLength, kAngle, kMass, kTime, kAny };

/// A number in SI units, or what is wrong with it.
struct ParsedNumber {
  double value = 0;
  bool has_unit = false;
  std::string error;  // empty: fine
};

/// Reads `word` as a finite number with an optional unit of `quantity`: `90deg`, `20cm`, `0.5kg`, `10ms`.
ParsedNumber ParseNumber(std::string_view word, Quantity quantity);

/// The finite number that `word` is, without unit; nothing if it is none.
std::optional<double> ParsePlain(std::string_view word);

/// `value` for people: up to 12 digits, without trailing zeros.
std::string FormatNumber(double value);

}  // namespace coopdyn
