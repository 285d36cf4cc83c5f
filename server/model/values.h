// SPDX-License-Identifier: MIT
// Numbers, units and words as people write them in files. Pure functions; any thread; independent of the
// locale.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// ASCII letters to lower case; other bytes as they are.
std::string ToLower(std::string_view text);
/// And to upper case.
std::string ToUpper(std::string_view text);
/// Without spaces and tabs at both ends.
std::string_view Trim(std::string_view text);
/// The words between spaces and tabs.
std::vector<std::string> SplitWords(std::string_view text);
/// `a, b and c`, each in single quotes if `quoted`.
std::string JoinNames(std::span<const std::string> names, bool quoted = false);

/// The candidate nearest to `word` if it is near enough to be a slip; empty otherwise. Case-insensitive.
std::string Nearest(std::string_view word, std::span<const std::string> candidates);
/// `; did you mean 'x'?`, or `; known are a, b and c` if nothing is near.
std::string DidYouMean(std::string_view word, std::span<const std::string> candidates);

}  // namespace coopdyn
