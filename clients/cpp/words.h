// SPDX-License-Identifier: MIT
// Lists of names as texts.
#pragma once

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string>
#include <vector>

namespace coopdyn::client {

/// What stands between spaces.
inline std::vector<std::string> Words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

inline std::string Join(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

/// For an error: if there are many, the first of them and their number.
inline std::string ListOf(std::vector<std::string> words) {
  constexpr std::size_t kListed = 20;
  const std::size_t count = words.size();
  if (count == 0) return "none";
  if (count > kListed) words.resize(kListed);
  return Join(words, ", ") + (count > kListed ? ", … (" + std::to_string(count) + ")" : "");
}

/// What `name` is but for its capitals, as part of an error.
inline std::string Nearest(const std::string& name, const std::vector<std::string>& known) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  for (const std::string& word : known) {
    if (std::equal(name.begin(), name.end(), word.begin(), word.end(), same))
      return "did you mean " + word + "? ";
  }
  return "";
}

}  // namespace coopdyn::client
