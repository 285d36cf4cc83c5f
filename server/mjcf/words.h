// SPDX-License-Identifier: MIT
// Collects the warnings about a file, each once, for lines `warning: …` on stderr. One thread.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace coopdyn::mjcf {

class Words {
 public:
  /// Adds `text` once. `counts`: also report how often it was added.
  void Say(const std::string& text, bool counts = true) {
    auto [known, is_new] = counts_.try_emplace(text, 0);
    if (is_new) order_.push_back(text);
    known->second += counts ? 1 : 0;
  }
  std::vector<std::string> Lines() const {
    std::vector<std::string> lines;
    for (const std::string& text : order_) {
      const int count = counts_.at(text);
      lines.push_back(count > 1 ? text + " (" + std::to_string(count) + " times)" : text);
    }
    return lines;
  }

 private:
  std::map<std::string, int> counts_;
  std::vector<std::string> order_;
};

}  // namespace coopdyn::mjcf
