// SPDX-License-Identifier: MIT
// Parses and formats numbers with units in user files. Pure; any thread; locale-independent.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/words.h"

namespace coopdyn {

/// The quantity that a number measures, which determines its allowed units.
enum class Quantity { kPlain, kLength, kAngle, kMass, kTime, kAny };

/// A number in SI units, or an error.
struct ParsedNumber {
  double value = 0;
  bool has_unit = false;
  std::string error;  // empty if valid
};

/// Reads `word` as a finite number with an optional unit of `quantity`: `90deg`, `20cm`, `0.5kg`, `10ms`.
ParsedNumber ParseNumber(std::string_view word, Quantity quantity);

/// Reads `word` as a finite number without unit; nullopt if it is not one.
std::optional<double> ParsePlain(std::string_view word);

/// `value` for people: up to 12 digits, without trailing zeros.
std::string FormatNumber(double value);
/// Like FormatNumber(), with up to four decimals.
std::string Rounded4(double value);

/// `3 joints`.
std::string CountOf(std::size_t count, const std::string& noun);

}  // namespace coopdyn
