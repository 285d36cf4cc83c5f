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
  // Not in the middle of a UTF-8 character.
  while (word.size() > kMaxShown && !shown.empty() &&
         (static_cast<unsigned char>(shown.back()) & 0x80) != 0) {
    shown.pop_back();
  }
  return "'" + shown + (word.size() > kMaxShown ? "…'" : "'");
}

/// Both ways to read a comma without a space, e.g. `0,5`.
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

std::string ToLower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

std::string ToUpper(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return out;
}

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> SplitWords(std::string_view text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(" \t", at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::string JoinNames(std::span<const std::string> names, bool quoted) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " and " : ", ";
    out += quoted ? "'" + names[i] + "'" : names[i];
  }
  return out;
}

namespace {

/// Edits (insert, remove, replace, swap of neighbours) that turn `a` into `b`.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        now[j] = std::min(now[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

}  // namespace

std::string Nearest(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t kLongest = 64;
  if (word.empty() || word.size() > kLongest) return {};
  const std::string lower = ToLower(word);
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, std::min<std::size_t>(3, word.size() / 2)) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = EditDistance(lower, ToLower(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string DidYouMean(std::string_view word, std::span<const std::string> candidates) {
  const std::string best = Nearest(word, candidates);
  if (!best.empty()) return "; did you mean '" + best + "'?";
  if (candidates.empty()) return {};
  constexpr std::size_t kShown = 24;
  if (candidates.size() > kShown) return "; known are " + JoinNames(candidates.first(kShown)) + " and others";
  return "; known are " + JoinNames(candidates);
}

}  // namespace coopdyn
