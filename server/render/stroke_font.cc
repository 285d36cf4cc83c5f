// SPDX-License-Identifier: MIT
#include "server/render/stroke_font.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string_view>

namespace coopdyn {

namespace {

struct Entry {
  char c;
  double width;
  // Strokes end with ';'. L x y x y …: a line through points. A x y rx ry from to: an arc about (x, y),
  // degrees, clockwise if `to` is less than `from`.
  std::string_view strokes;
};

constexpr std::array kGlyphs = std::to_array<Entry>({
    {'A', 64, "L 0 0 32 90 64 0;L 11 30 53 30;"},
    {'B', 57, "L 34 0 0 0 0 90 32 90;A 32 68 22 22 90 -90;L 34 46 0 46;A 34 23 23 23 90 -90;"},
    {'C', 62, "A 34 45 34 45 45 315;"},
    {'D', 62, "L 22 90 0 90 0 0 22 0;A 22 45 40 45 90 -90;"},
    {'E', 48, "L 48 90 0 90 0 0 48 0;L 0 46 40 46;"},
    {'F', 46, "L 46 90 0 90 0 0;L 0 46 38 46;"},
    {'G', 68, "A 34 45 34 45 45 360;L 68 45 40 45;"},
    {'H', 60, "L 0 0 0 90;L 60 0 60 90;L 0 46 60 46;"},
    {'I', 0, "L 0 0 0 90;"},
    {'J', 40, "L 40 90 40 24;A 20 24 20 24 0 -180;"},
    {'K', 56, "L 0 0 0 90;L 54 90 0 36;L 18 54 56 0;"},
    {'L', 44, "L 0 90 0 0 44 0;"},
    {'M', 72, "L 0 0 0 90 36 30 72 90 72 0;"},
    {'N', 60, "L 0 0 0 90 60 0 60 90;"},
    {'O', 68, "A 34 45 34 45 0 360;"},
    {'P', 52, "L 0 0 0 90 28 90;A 28 66 24 24 90 -90;L 28 42 0 42;"},
    {'Q', 68, "A 34 45 34 45 0 360;L 42 22 68 -6;"},
    {'R', 54, "L 0 0 0 90 28 90;A 28 66 24 24 90 -90;L 28 42 0 42;L 28 42 54 0;"},
    {'S', 54, "A 27 67 25 23 40 270;A 27 22 27 22 90 -140;"},
    {'T', 60, "L 0 90 60 90;L 30 90 30 0;"},
    {'U', 60, "L 0 90 0 30;A 30 30 30 30 180 360;L 60 30 60 90;"},
    {'V', 64, "L 0 90 32 0 64 90;"},
    {'W', 88, "L 0 90 22 0 44 80 66 0 88 90;"},
    {'X', 60, "L 0 0 60 90;L 0 90 60 0;"},
    {'Y', 60, "L 0 90 30 42 60 90;L 30 42 30 0;"},
    {'Z', 56, "L 0 90 56 90 0 0 56 0;"},
    {'a', 46, "A 23 32 23 32 0 360;L 46 64 46 0;"},
    {'b', 46, "L 0 90 0 0;A 23 32 23 32 0 360;"},
    {'c', 42, "A 24 32 24 32 45 315;"},
    {'d', 46, "A 23 32 23 32 0 360;L 46 90 46 0;"},
    {'e', 46, "L 0 33 46 33;A 23 32 23 32 0 315;"},
    {'f', 32, "A 32 68 20 22 90 180;L 12 68 12 0;L 0 60 28 60;"},
    {'g', 46, "A 23 32 23 32 0 360;L 46 64 46 -4;A 23 -4 23 20 0 -150;"},
    {'h', 44, "L 0 90 0 0;A 22 40 22 24 180 0;L 44 40 44 0;"},
    {'i', 0, "L 0 64 0 0;L 0 87 0 89;"},
    {'j', 14, "L 14 64 14 -6;A -2 -6 16 18 0 -90;L 14 87 14 89;"},
    {'k', 42, "L 0 90 0 0;L 40 64 0 26;L 14 40 42 0;"},
    {'l', 14, "L 0 90 0 14;A 14 14 14 14 180 270;"},
    {'m', 72, "L 0 64 0 0;A 18 44 18 20 180 0;L 36 44 36 0;A 54 44 18 20 180 0;L 72 44 72 0;"},
    {'n', 44, "L 0 64 0 0;A 22 40 22 24 180 0;L 44 40 44 0;"},
    {'o', 48, "A 24 32 24 32 0 360;"},
    {'p', 46, "L 0 64 0 -26;A 23 32 23 32 0 360;"},
    {'q', 46, "A 23 32 23 32 0 360;L 46 64 46 -26;"},
    {'r', 28, "L 0 64 0 0;A 24 36 24 28 180 80;"},
    {'s', 40, "A 20 48 18 16 40 270;A 20 16 20 16 90 -140;"},
    {'t', 30, "L 12 84 12 16;A 28 16 16 16 180 270;L 0 62 30 62;"},
    {'u', 44, "L 0 64 0 24;A 22 24 22 24 180 360;L 44 64 44 0;"},
    {'v', 46, "L 0 64 23 0 46 64;"},
    {'w', 68, "L 0 64 17 0 34 56 51 0 68 64;"},
    {'x', 44, "L 0 0 44 64;L 0 64 44 0;"},
    {'y', 46, "L 0 64 23 2;L 46 64 14 -26;"},
    {'z', 42, "L 0 64 42 64 0 0 42 0;"},
    {'0', 52, "A 26 45 26 45 0 360;"},
    {'1', 24, "L 0 70 22 90 22 0;"},
    {'2', 52, "A 25 65 25 25 170 -35;L 45 51 0 0 52 0;"},
    {'3', 50, "A 24 67 23 23 155 -90;A 24 22 26 22 90 -155;"},
    {'4', 56, "L 42 0 42 90 0 28 56 28;"},
    {'5', 50, "L 46 90 6 90 2 44;A 24 29 26 29 148 -150;"},
    {'6', 52, "A 26 28 26 28 0 360;L 42 90 4 40;"},
    {'7', 50, "L 0 90 50 90 16 0;"},
    {'8', 52, "A 26 67 22 23 0 360;A 26 22 26 22 0 360;"},
    {'9', 52, "A 26 62 26 28 0 360;L 48 50 10 0;"},
    {'_', 50, "L 0 -8 50 -8;"},
    {'-', 34, "L 0 36 34 36;"},
    {' ', 24, ""},
});

constexpr Entry kUnknown{'?', 40, "L 0 0 0 90 40 90 40 0 0 0;"};

Glyph::Stroke MakeArc(const std::vector<double>& v) {
  constexpr double kDegree = std::numbers::pi / 180;
  constexpr double kStep_deg = 15;
  Glyph::Stroke stroke;
  const int steps = static_cast<int>(std::ceil(std::abs(v[5] - v[4]) / kStep_deg));
  for (int i = 0; i <= steps; ++i) {
    const double angle = (v[4] + (v[5] - v[4]) * i / steps) * kDegree;
    stroke.push_back({v[0] + v[2] * std::cos(angle), v[1] + v[3] * std::sin(angle)});
  }
  return stroke;
}

Glyph::Stroke MakeStroke(std::string_view text) {
  std::vector<double> values;
  const char* at = text.data() + 1;  // a literal: ends with ';', which stops every number
  while (*at != ';') {
    char* end = nullptr;
    values.push_back(static_cast<double>(std::strtol(at, &end, 10)));
    at = end;
  }
  if (text.front() == 'A') return MakeArc(values);
  Glyph::Stroke stroke;
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) stroke.push_back({values[i], values[i + 1]});
  return stroke;
}

}  // namespace

Glyph MakeGlyph(char c) {
  const Entry* entry = &kUnknown;
  for (const Entry& candidate : kGlyphs) {
    if (candidate.c == c) entry = &candidate;
  }
  Glyph glyph;
  glyph.width = entry->width;
  for (std::string_view rest = entry->strokes; !rest.empty(); rest.remove_prefix(rest.find(';') + 1)) {
    glyph.strokes.push_back(MakeStroke(rest));
  }
  return glyph;
}

}  // namespace coopdyn
