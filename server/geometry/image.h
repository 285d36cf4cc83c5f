// SPDX-License-Identifier: MIT
// A picture in memory. Immutable; thread-safe.
#pragma once

#include <cstdint>
#include <vector>

namespace coopdyn {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // row by row, top row first
};

}  // namespace coopdyn
