// SPDX-License-Identifier: MIT
#include "server/model/values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace coopdyn {

namespace {

struct Unit {
  std::string_view name;
  Quantity quantity;
  double factor;
};

constexpr Unit kUnits[] = {
    {"m", Quantity::kLength, 1},
    {"cm", Quantity::kLength, 0.01},
    {"mm", Quantity::kLength, 1e-3},
    {"rad", Quantity::kAngle, 1},
    {"deg", Quantity::kAngle, std::numbers::pi / 180},
    {"kg", Quantity::kMass, 1},
    {"g", Quantity::kMass, 1e-3},
    {"s", Quantity::kTime, 1},
    {"ms", Quantity::kTime, 1e-3},
};

std::string UnitsOf(Quantity quantity) {
  std::vector<std::string> names;
  for (const Unit& unit : kUnits) {
    if (unit.quantity == quantity || quantity == Quantity::kAny) names.emplace_back(unit.name);
  }
  return names.empty() ? "no unit belongs here" : "units here are " + JoinNames(names);
}

std::string Quote(std::string_view word) {
  constexpr std::size_t kMaxShown = 60;
  std::string shown(word.substr(0, kMaxShown));
  // Do not cut a UTF-8 character.
  while (word.size() > kMaxShown && !shown.empty() &&
         (static_cast<unsigned char>(shown.back()) & 0x80) != 0) {
    shown.pop_back();
  }
  return "'" + shown + (word.size() > kMaxShown ? "…'" : "'");
}

/// The error for a comma without a space, e.g. `0,5`, with both possible corrections.
std::string CommaError(std::string_view word) {
  std::string spaced, with_point;
  int commas = 0;
  for (const char c : word) {
    if (c == ',') ++commas;
    spaced += c == ',' ? std::string(spaced.empty() ? "" : " ") : std::string(1, c);
    with_point += c == ',' ? '.' : c;
  }
  if (commas == 1 && word.front() != ',' && word.back() != ',') {
    return Quote(word) + " can be read in two ways: write " + with_point + " for one number, or " + spaced +
           " for two";
  }
  return Quote(word) + " has a comma without a space: write " + spaced + ", with a point for decimals";
}

}  // namespace

ParsedNumber ParseNumber(std::string_view word, Quantity quantity) {
  ParsedNumber out;
  if (word.find(',') != std::string_view::npos) {
    out.error = CommaError(word);
    return out;
  }
  std::string_view digits = word;
  if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), out.value);
  if (code == std::errc::result_out_of_range) {
    out.error = Quote(word) + " is too large or too small for a number";
    return out;
  }
  if (code != std::errc() || end == digits.data()) {
    out.error = Quote(word) + " is not a number";
    return out;
  }
  if (!std::isfinite(out.value)) {
    out.error = Quote(word) + " is not a finite number";
    return out;
  }
  const std::string unit_word = ToLower(digits.substr(static_cast<std::size_t>(end - digits.data())));
  if (unit_word.empty()) return out;
  for (const Unit& unit : kUnits) {
    if (unit.name == unit_word && (unit.quantity == quantity || quantity == Quantity::kAny)) {
      out.value *= unit.factor;
      out.has_unit = true;
      return out;
    }
  }
  out.error = Quote(word) + " is not a number with a known unit; " + UnitsOf(quantity);
  return out;
}

std::optional<double> ParsePlain(std::string_view word) {
  const ParsedNumber number = ParseNumber(word, Quantity::kPlain);
  if (!number.error.empty()) return std::nullopt;
  return number.value;
}

std::string FormatNumber(double value) {
  constexpr int kDigits = 12;
  char buffer[40];
  const auto [end, code] =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, kDigits);
  return code == std::errc() ? std::string(buffer, end) : std::string("?");
}

std::string Rounded4(double value) {
  return FormatNumber(std::round(value * 1e4) / 1e4);
}

std::string CountOf(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace coopdyn
