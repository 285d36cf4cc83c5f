// SPDX-License-Identifier: MIT
// A colour with its opacity, sRGB, each part from 0 to 1. Any thread.
#pragma once

namespace coopdyn {

struct Rgba {
  double r, g, b, a;
};

}  // namespace coopdyn
