// SPDX-License-Identifier: MIT
// The words of YARS's own command line as those of `coopdyn serve`. Pure.
#pragma once

#include <string>
#include <vector>

namespace coopdyn {

struct YarsWords {
  std::vector<std::string> serve;  // what stands behind `coopdyn serve`
  std::vector<std::string> notes;  // words that change nothing here, and what to use instead
  std::string error;               // what is wrong, and what to write; empty: nothing
  std::string told;                // what is told instead of a run; empty: it runs
};

YarsWords ReadYarsWords(const std::vector<std::string>& words);

/// What --help says.
std::string YarsHelp();

}  // namespace coopdyn
