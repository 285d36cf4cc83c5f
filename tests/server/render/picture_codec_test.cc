// SPDX-License-Identifier: MIT
#include "server/render/picture.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/server/render/decode.h"

namespace coopdyn {
namespace {

// A smooth picture: red grows to the right, green downwards.
Picture Gradient(int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(3UL * static_cast<unsigned>(width * height))};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at(x, y)[0] = static_cast<std::uint8_t>(255 * x / width);
      picture.at(x, y)[1] = static_cast<std::uint8_t>(255 * y / height);
      picture.at(x, y)[2] = 90;
    }
  }
  return picture;
}

TEST(ImageCodecTest, PngGivesBackEveryPixel) {
  const Picture picture = Gradient(123, 45);
  const auto bytes = EncodePng(picture);
  ASSERT_TRUE(bytes);
  const Picture back = DecodePng(*bytes);
  EXPECT_EQ(back.width, 123);
  EXPECT_EQ(back.height, 45);
  EXPECT_EQ(back.rgb, picture.rgb);
}

TEST(ImageCodecTest, JpegGivesBackNearlyEveryPixel) {
  const Picture picture = Gradient(160, 120);
  const auto bytes = EncodeJpeg(picture, 85);
  ASSERT_TRUE(bytes);
  const Picture back = DecodeJpeg(*bytes);
  ASSERT_EQ(back.width, 160);
  ASSERT_EQ(back.height, 120);
  int worst = 0;
  for (std::size_t i = 0; i < back.rgb.size(); ++i)
    worst = std::max(worst, std::abs(back.rgb[i] - picture.rgb[i]));
  EXPECT_LT(worst, 16);
}

TEST(ImageCodecTest, AWorseJpegIsSmaller) {
  const Picture picture = Gradient(160, 120);
  EXPECT_LT(EncodeJpeg(picture, 20)->size(), EncodeJpeg(picture, 95)->size());
}

}  // namespace
}  // namespace coopdyn
