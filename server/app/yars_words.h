// SPDX-License-Identifier: MIT
// The words of YARS's own command line as those of `coopdyn serve`. Pure.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct YarsWords {
  std::vector<std::string> serve;  // what stands behind `coopdyn serve`
  std::vector<std::string> notes;  // words that change nothing here, and what to use instead
  std::string error;               // what is wrong, and what to write; empty: nothing
  bool help = false;
};

/// `step_s`: the length of a step of an experiment, for --iterations; nothing if it cannot be read.
YarsWords ReadYarsWords(const std::vector<std::string>& words,
                        const std::function<std::optional<double>(const std::string& file)>& step_s);

/// What --help says.
std::string YarsHelp();

}  // namespace coopdyn
