// SPDX-License-Identifier: MIT
// Lists of names as texts.
#pragma once

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

}  // namespace coopdyn::client
