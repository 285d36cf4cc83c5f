// SPDX-License-Identifier: MIT
// The colours with which views show the words of scenarios (red, blue, …). These mean pure colours, which
// glare on a screen and which colour-blind eyes confuse; the shown ones are calm and differ in lightness,
// too. Robots' cameras see the written colours. The page shows the same: server/web/page/palette.js. sRGB, 0
// to 1; any thread.
#pragma once

#include <cmath>
#include <utility>

#include "server/model/world_model.h"

namespace coopdyn {

/// The colour with which a view shows `color`; any other than those of words stays.
inline Color ShownColor(const Color& color) {
  static constexpr std::pair<Color, Color> kShown[] = {
      {{1, 0, 0}, {0.74, 0.20, 0.19}},           // red
      {{0, 0.8, 0}, {0.20, 0.67, 0.31}},         // green
      {{0, 0, 1}, {0.18, 0.44, 0.78}},           // blue
      {{1, 1, 0}, {0.96, 0.85, 0.38}},           // yellow
      {{1, 0, 1}, {0.76, 0.38, 0.60}},           // magenta
      {{0, 1, 1}, {0.45, 0.80, 0.90}},           // cyan
      {{1, 0.55, 0}, {0.90, 0.52, 0.18}},        // orange
      {{0.5, 0, 0.7}, {0.37, 0.22, 0.50}},       // purple
      {{0.55, 0.27, 0.07}, {0.52, 0.36, 0.24}},  // brown
      {{1, 0.6, 0.75}, {0.92, 0.70, 0.76}},      // pink
      {{0.6, 1, 0}, {0.64, 0.78, 0.30}},         // lime
      {{0, 0, 0.5}, {0.16, 0.23, 0.43}},         // navy
      {{0, 0.5, 0.5}, {0.16, 0.52, 0.53}},       // teal
      {{0.5, 0, 0}, {0.48, 0.18, 0.21}},         // maroon
      {{1, 0.84, 0}, {0.86, 0.70, 0.28}},        // gold
      {{0.56, 0, 1}, {0.51, 0.38, 0.79}},        // violet
      {{0.2, 0.4, 0.9}, {0.25, 0.46, 0.78}},     // of robots without a colour
  };
  const auto close = [](double a, double b) { return std::abs(a - b) < 1e-3; };
  for (const auto& [written, shown] : kShown) {
    if (close(written.r, color.r) && close(written.g, color.g) && close(written.b, color.b)) return shown;
  }
  return color;
}

}  // namespace coopdyn
