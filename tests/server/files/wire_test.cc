// SPDX-License-Identifier: MIT
// The bytes between coopdyn and coopdyn-files: there and back, and damaged ones.
#include "server/files/wire.h"

#include <gtest/gtest.h>

#include <memory>

namespace coopdyn {
namespace {

/// Two triangles, half of them with a picture.
MeshAnswer SomeMesh() {
  auto image = std::make_shared<Image>();
  *image = {2, 1, {1, 2, 3, 4, 5, 6}};
  auto skin = std::make_shared<MeshSkin>();
  skin->materials = {{{1, 0, 0}, {1, 1, 1}, nullptr}, TexturedMaterial(image, {1, 0.5, 1})};
  skin->corners = {{{0, 0}, 0}, {{1, 0}, 0}, {{0, 1}, 1}, {{1, 1}, 1}};
  MeshAnswer answer;
  answer.warnings = {"the texture 'x' is not drawn"};
  answer.parts = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}}, {{0, 1, 2}, {1, 3, 2}}, {{1, 0, 0}}, skin};
  return answer;
}

TEST(FilesWireTest, AMeshComesBackAsItWas) {
  const MeshAnswer sent = SomeMesh();
  const auto got = MeshAnswerOf(ToBytes(sent));
  ASSERT_TRUE(got);
  EXPECT_EQ(got->warnings, sent.warnings);
  EXPECT_EQ(got->parts.vertices, sent.parts.vertices);
  EXPECT_EQ(got->parts.triangles, sent.parts.triangles);
  EXPECT_EQ(got->parts.color, sent.parts.color);
  ASSERT_NE(got->parts.skin, nullptr);
  ASSERT_EQ(got->parts.skin->materials.size(), 2u);
  ASSERT_NE(got->parts.skin->materials[1].texture, nullptr);
  EXPECT_EQ(got->parts.skin->materials[1].texture->rgb, sent.parts.skin->materials[1].texture->rgb);
  EXPECT_EQ(got->parts.skin->corners[3].uv, sent.parts.skin->corners[3].uv);
}

TEST(FilesWireTest, PicturesAndHeightsComeBackAsTheyWere) {
  const auto image = ImageOf(ToBytes(Image{1, 2, {1, 2, 3, 4, 5, 6}}));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->rgb, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}));
  const auto heights = HeightsOf(ToBytes(Heights{2, 1, {0, 65535}}));
  ASSERT_TRUE(heights);
  EXPECT_EQ(heights->At(0.5, 0), 0.5);
}

TEST(FilesWireTest, BytesThatEndEarlyAreRefused) {
  const auto check = [](const std::vector<std::byte>& bytes, auto read) {
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FALSE(read(std::span(bytes).first(size)).has_value()) << size;
  };
  check(ToBytes(SomeMesh()), &MeshAnswerOf);
  check(ToBytes(MeshRequest{"a.stl", "x", {1, 2, 3}, "part"}), &MeshRequestOf);
  check(ToBytes(Image{1, 2, {1, 2, 3, 4, 5, 6}}), &ImageOf);
  check(ToBytes(Heights{2, 1, {0, 65535}}), &HeightsOf);
}

/// A changed byte is refused, or yields a mesh with valid numbers.
TEST(FilesWireTest, NoChangedByteMakesABadMesh) {
  const std::vector<std::byte> good = ToBytes(SomeMesh());
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const int byte : {0, 1, 0x7f, 0x80, 0xff}) {
      std::vector<std::byte> bytes = good;
      bytes[at] = static_cast<std::byte>(byte);
      const auto mesh = MeshAnswerOf(bytes);
      if (!mesh) continue;
      for (const auto& triangle : mesh->parts.triangles) {
        for (const auto corner : triangle) ASSERT_LT(corner, mesh->parts.vertices.size());
      }
      if (mesh->parts.skin == nullptr) continue;
      ASSERT_EQ(mesh->parts.skin->corners.size(), mesh->parts.vertices.size());
      for (const auto& corner : mesh->parts.skin->corners)
        ASSERT_LT(corner.material, mesh->parts.skin->materials.size());
    }
  }
}

TEST(FilesWireTest, APictureOfOtherThanItsSizeIsRefused) {
  EXPECT_FALSE(ImageOf(ToBytes(Image{2, 2, {1, 2, 3}})));
  EXPECT_FALSE(ImageOf(ToBytes(Image{0, 0, {}})));
  EXPECT_FALSE(ImageOf(ToBytes(Image{-1, -1, {1, 2, 3}})));
  EXPECT_FALSE(HeightsOf(ToBytes(Heights{1 << 16, 1 << 16, {}})));
}

}  // namespace
}  // namespace coopdyn
