// SPDX-License-Identifier: MIT
// Splits and joins lists of names, encodes URLs, and checks numbers.
#pragma once

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cpp/error.h"

namespace coopdyn::client {

/// Splits `text` at whitespace.
inline std::vector<std::string> Words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// Returns the only word of `text`; throws Error 3 otherwise.
inline std::string Word(const std::string& text, const char* what) {
  const std::vector<std::string> words = Words(text);
  if (words.size() != 1) throw Error(3, std::string(what) + " is one word, not '" + text + "'");
  return words[0];
}

inline std::string FirstWord(const std::string& text) {
  return text.substr(0, text.find(' '));
}

inline std::string Join(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

/// Lists words for an error; of many, the first and their total number.
inline std::string ListOf(std::vector<std::string> words) {
  constexpr std::size_t kListed = 20;
  const std::size_t count = words.size();
  if (count == 0) return "none";
  if (count > kListed) words.resize(kListed);
  return Join(words, ", ") + (count > kListed ? ", … (" + std::to_string(count) + ")" : "");
}

/// `text` as a part of a URL: all but letters, digits, -, _, . and the characters in `kept` become %XX.
inline std::string PercentEncoded(const std::string& text, std::string_view kept = "") {
  constexpr const char* kHex = "0123456789ABCDEF";
  std::string out;
  for (const unsigned char c : text) {
    const char byte = static_cast<char>(c);
    if (std::isalnum(c) != 0 || byte == '-' || byte == '_' || byte == '.' || kept.find(byte) != kept.npos) {
      out += byte;
    } else {
      out += {'%', kHex[c >> 4], kHex[c & 15]};
    }
  }
  return out;
}

/// Suggests, as part of an error, the known word that differs from `name` only in case; else empty.
inline std::string Nearest(const std::string& name, const std::vector<std::string>& known) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  for (const std::string& word : known) {
    if (std::equal(name.begin(), name.end(), word.begin(), word.end(), same))
      return "did you mean " + word + "? ";
  }
  return "";
}

/// Returns `value`; throws Error 4 that names `what` if it is not finite.
inline double Finite(double value, const char* what) {
  if (!std::isfinite(value)) throw Error(4, std::string(what) + " must be finite");
  return value;
}

/// `value` truncated to an integer, as the daemon writes integers; 0 if out of range or nan.
inline std::int64_t Whole(double value) {
  return std::abs(value) < 9e18 ? static_cast<std::int64_t>(value) : 0;
}

/// `value` as a decimal text.
inline std::string Written(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

}  // namespace coopdyn::client
