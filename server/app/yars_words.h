// SPDX-License-Identifier: MIT
// Translates YARS's command line to that of `coopdyn serve`. Pure.
#pragma once

#include <string>
#include <vector>

namespace coopdyn {

struct YarsWords {
  std::vector<std::string> serve;  // arguments of `coopdyn serve`
  std::vector<std::string> notes;  // words without effect here, and what to use instead
  std::string error;               // the error, and what to write instead; empty: none
  std::string told;                // text to print instead of a run; empty: run
};

YarsWords ReadYarsWords(const std::vector<std::string>& words);

/// The text of --help.
std::string YarsHelp();

}  // namespace coopdyn
