// SPDX-License-Identifier: MIT
// A small alphabet of lines and arcs, for the names of robots: letters, digits, '_' and '-'. Pure; any
// thread.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace coopdyn {

/// Capitals are 90 units high, x 64; the baseline is y = 0, y points up.
struct Glyph {
  using Stroke = std::vector<Eigen::Vector2d>;
  std::vector<Stroke> strokes;
  double width = 0;  // without the pen
};

inline constexpr double kGlyphCapHeight = 90;
inline constexpr double kGlyphDescent = 28;  // below the baseline
inline constexpr double kGlyphGap = 24;      // between two glyphs, from edge to edge without the pen

/// The glyph of `c`; an empty frame if there is none.
Glyph MakeGlyph(char c);

}  // namespace coopdyn
