// SPDX-License-Identifier: MIT
#include "server/render/label_painter.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace coopdyn {
namespace {

std::vector<std::uint8_t> PixelsOf(const std::string& text) {
  Picture picture{64, 64, std::vector<std::uint8_t>(3 * 64 * 64)};
  LabelPainter().Paint(picture, {{text, 32, 50, {1, 0, 0}}});
  return picture.rgb;
}

TEST(LabelPainterTest, EveryLetterOfANameLooksDifferent) {
  std::set<std::vector<std::uint8_t>> seen{PixelsOf(" "), PixelsOf("\x01")};  // the second has no glyph
  std::size_t count = 2;
  for (const char c : std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-")) {
    seen.insert(PixelsOf(std::string(1, c)));
    EXPECT_EQ(seen.size(), ++count) << c;
  }
}

TEST(LabelPainterTest, ALongNameIsCut) {
  const std::string start(22, 'w');
  EXPECT_EQ(PixelsOf(start + "wwwww"), PixelsOf(start + "wwwwwwwww"));
}

TEST(LabelPainterTest, WhatLiesFarOutsideIsLeftOut) {
  Picture picture{8, 8, std::vector<std::uint8_t>(3 * 8 * 8)};
  const Picture before = picture;
  LabelPainter().Paint(picture, {{"robot1", 1e12, -1e12, {1, 0, 0}}});
  EXPECT_EQ(picture.rgb, before.rgb);
}

}  // namespace
}  // namespace coopdyn
