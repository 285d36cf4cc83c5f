// SPDX-License-Identifier: MIT
#include "protocol/text_scan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "protocol/ascii.h"
#include "protocol/codec.h"

namespace coopdyn {
namespace {

std::size_t CountDigits(std::string_view text) {
  return static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), IsDigit) - text.begin());
}

bool EqualsIgnoringCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return ToLower(x) == ToLower(y); });
}

/// The parts of a decimal number without its sign.
struct Decimal {
  std::string_view whole;
  std::string_view fraction;
  std::string_view exponent;  // with its sign
};

bool SplitDecimal(std::string_view text, Decimal& parts) {
  parts.whole = text.substr(0, CountDigits(text));
  text.remove_prefix(parts.whole.size());
  if (!text.empty() && text.front() == '.') {
    text.remove_prefix(1);
    parts.fraction = text.substr(0, CountDigits(text));
    text.remove_prefix(parts.fraction.size());
  }
  if (parts.whole.empty() && parts.fraction.empty()) return false;
  if (text.empty()) return true;
  if (ToLower(text.front()) != 'e') return false;
  parts.exponent = text.substr(1);
  std::string_view digits = parts.exponent;
  if (!digits.empty() && (digits.front() == '+' || digits.front() == '-')) digits.remove_prefix(1);
  return !digits.empty() && CountDigits(digits) == digits.size();
}

/// True if a number outside the range of double is too large, false if too small.
bool IsHuge(const Decimal& parts) {
  std::string_view exponent = parts.exponent;
  if (!exponent.empty() && exponent.front() == '+') exponent.remove_prefix(1);
  std::int64_t power = 0;
  if (std::from_chars(exponent.data(), exponent.data() + exponent.size(), power).ec ==
      std::errc::result_out_of_range) {
    return exponent.front() != '-';
  }
  const std::size_t first = parts.whole.find_first_not_of('0');
  if (first != std::string_view::npos) {
    return power > -static_cast<std::int64_t>(parts.whole.size() - first);
  }
  const std::size_t zeros = std::min(parts.fraction.find_first_not_of('0'), parts.fraction.size());
  return power > static_cast<std::int64_t>(zeros);
}

}  // namespace

NumberRead ReadInt32(std::string_view token, std::int32_t& value) {
  std::string_view digits = token;
  if (!digits.empty() && (digits.front() == '+' || digits.front() == '-')) digits.remove_prefix(1);
  if (digits.empty() || CountDigits(digits) != digits.size()) {
    double other = 0;
    return ReadDouble(token, other) == NumberRead::kNotNumber ? NumberRead::kNotNumber
                                                              : NumberRead::kHasPoint;
  }
  if (token.front() == '+') token.remove_prefix(1);
  const auto result = std::from_chars(token.data(), token.data() + token.size(), value);
  return result.ec == std::errc{} ? NumberRead::kOk : NumberRead::kOutOfRange;
}

NumberRead ReadDouble(std::string_view token, double& value) {
  bool negative = false;
  if (!token.empty() && (token.front() == '+' || token.front() == '-')) {
    negative = token.front() == '-';
    token.remove_prefix(1);
  }
  double magnitude = 0;
  if (EqualsIgnoringCase(token, "inf")) {
    magnitude = std::numeric_limits<double>::infinity();
  } else if (EqualsIgnoringCase(token, "nan")) {
    magnitude = std::numeric_limits<double>::quiet_NaN();
  } else {
    Decimal parts;
    if (!SplitDecimal(token, parts)) return NumberRead::kNotNumber;
    const auto result = std::from_chars(token.data(), token.data() + token.size(), magnitude);
    if (result.ec == std::errc::result_out_of_range) {
      if (IsHuge(parts)) return NumberRead::kOutOfRange;
      magnitude = 0;
    } else if (result.ec != std::errc{} || result.ptr != token.data() + token.size()) {
      return NumberRead::kNotNumber;
    }
  }
  value = negative ? -magnitude : magnitude;
  return NumberRead::kOk;
}

std::string Quoted(std::string_view token) {
  constexpr std::size_t kMost = 40;
  std::string quoted = "'";
  if (token.size() <= kMost) {
    quoted += token;
  } else {
    std::size_t end = kMost;
    while (end > 0 && (static_cast<unsigned char>(token[end]) & 0xC0) == 0x80) --end;
    quoted += token.substr(0, end);
    quoted += "…";
  }
  return quoted + "'";
}

std::string NotANumber(std::string_view token) {
  std::string text = Quoted(token) + " is not a number";
  if (token.empty() || token.size() > 64) return text;
  std::string changed(token);
  double value = 0;
  if (token.front() == '#') return text + ": a comment needs a line of its own";
  if (token.back() == ',' || token.back() == ';') {
    changed.pop_back();
    if (ReadDouble(changed, value) == NumberRead::kOk) return text + ": write " + changed;
  }
  const std::size_t comma = token.find(',');
  if (comma != std::string_view::npos) {
    changed[comma] = '.';
    if (ReadDouble(changed, value) == NumberRead::kOk) return text + ": write " + changed;
    changed = token;
    std::replace(changed.begin(), changed.end(), ',', ' ');
    return text + ": put spaces between values, " + changed;
  }
  std::size_t digits = token.size();
  while (digits > 0 && ReadDouble(token.substr(0, digits), value) != NumberRead::kOk) --digits;
  if (digits > 0 && IsDigit(token.front())) {
    return text + ": values have no units, write " + std::string(token.substr(0, digits));
  }
  return text;
}

void AppendDouble(double value, std::string& out) {
  if (std::isnan(value)) {
    out += "nan";
    return;
  }
  if (std::isinf(value)) {
    out += value < 0 ? "-inf" : "inf";
    return;
  }
  const double magnitude = std::abs(value);
  const bool fixed = magnitude == 0 || (magnitude >= 1e-4 && magnitude < 1e16);
  std::array<char, 64> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                    fixed ? std::chars_format::fixed : std::chars_format::scientific);
  const std::string_view digits(buffer.data(), static_cast<std::size_t>(result.ptr - buffer.data()));
  out += digits;
  if (fixed && digits.find('.') == std::string_view::npos) out += ".0";
}

}  // namespace coopdyn
