// SPDX-License-Identifier: MIT
#include "server/state/run_control.h"

#include <array>
#include <cstddef>

namespace coopdyn {

const char* ToString(RunState state) {
  constexpr std::array kNames{"running", "paused", "waiting", "playing", "ended"};
  return kNames[static_cast<std::size_t>(state)];
}

const char* ToString(RunEnd end) {
  constexpr std::array kNames{"duration", "controller", "recording", "quit", "signal", "score"};
  return kNames[static_cast<std::size_t>(end)];
}

const char* WhyEarly(RunEnd end) {
  constexpr std::array kTexts{"for an unknown reason",
                              "because a controller failed",
                              "because the recording failed",
                              "by quit",
                              "by a signal",
                              "by a score"};
  return kTexts[static_cast<std::size_t>(end)];
}

}  // namespace coopdyn
