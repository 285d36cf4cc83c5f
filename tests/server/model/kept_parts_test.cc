// SPDX-License-Identifier: MIT
// Parts of meshes that are cached in files.
#include "server/model/kept_parts.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "server/geometry/convex_parts.h"
#include "tests/server/base/temp_folder.h"
#include "tests/server/geometry/concave_solids.h"

namespace coopdyn {
namespace {

MeshData CupMesh() {
  const Triangles cup = Cup();
  Vector3 middle;
  return MakeMesh(cup.vertices, cup.triangles, middle);
}

std::filesystem::path OnlyFile(const TempFolder& folder) {
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
  return std::filesystem::directory_iterator(folder.path())->path();
}

TEST(KeptPartsTest, TheyAreThoseOfTheMesh) {
  const TempFolder folder;
  const MeshData cup = CupMesh();
  const PartCorners made = KeptConvexParts(cup, kMostConvexParts, {});
  EXPECT_GT(made.size(), 4u);
  EXPECT_EQ(KeptConvexParts(cup, kMostConvexParts, folder.path()), made);
  OnlyFile(folder);
  EXPECT_EQ(KeptConvexParts(cup, kMostConvexParts, folder.path()), made);
}

TEST(KeptPartsTest, WhatIsKeptIsNotComputedAgain) {
  const TempFolder folder;
  const MeshData cup = CupMesh();
  PartCorners made = KeptConvexParts(cup, kMostConvexParts, folder.path());
  made.pop_back();
  const std::string fewer = PartsToBytes(made, cup, kMostConvexParts);
  std::ofstream(OnlyFile(folder), std::ios::binary) << fewer;
  EXPECT_EQ(KeptConvexParts(cup, kMostConvexParts, folder.path()), made);
}

TEST(KeptPartsTest, AnotherNumberOfPartsIsAnotherFile) {
  const TempFolder folder;
  const MeshData cup = CupMesh();
  const PartCorners many = KeptConvexParts(cup, kMostConvexParts, folder.path());
  EXPECT_LE(KeptConvexParts(cup, 4, folder.path()).size(), 4u);
  EXPECT_EQ(KeptConvexParts(cup, kMostConvexParts, folder.path()), many);
}

TEST(KeptPartsTest, ADamagedFileIsMadeAgain) {
  const TempFolder folder;
  const MeshData cup = CupMesh();
  const PartCorners made = KeptConvexParts(cup, kMostConvexParts, folder.path());
  const std::filesystem::path file = OnlyFile(folder);
  const std::string good = PartsToBytes(made, cup, kMostConvexParts);
  for (std::string bad : {std::string(), good.substr(0, 100), good + "x", std::string(2 << 20, 'a')}) {
    std::ofstream(file, std::ios::binary) << bad;
    EXPECT_EQ(KeptConvexParts(cup, kMostConvexParts, folder.path()), made);
    std::ifstream stream(file, std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), good);
  }
}

TEST(KeptPartsTest, HostileBytesAreRefused) {
  const MeshData cup = CupMesh();
  const PartCorners made = KeptConvexParts(cup, kMostConvexParts, {});
  const std::string good = PartsToBytes(made, cup, kMostConvexParts);
  ASSERT_EQ(PartsFromBytes(good, cup, kMostConvexParts), made);
  for (std::size_t i = 0; i < good.size(); i += 97) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 1);
    EXPECT_FALSE(PartsFromBytes(bad, cup, kMostConvexParts)) << i;
  }
  const auto refused = [&](const PartCorners& parts) {
    return !PartsFromBytes(PartsToBytes(parts, cup, kMostConvexParts), cup, kMostConvexParts);
  };
  EXPECT_TRUE(refused({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));  // outside the mesh
  EXPECT_TRUE(refused({{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}}}));       // no solid
  EXPECT_TRUE(refused(PartCorners(17, made[0])));                        // too many
  EXPECT_TRUE(refused({std::vector<Vector3>(5, Vector3::Constant(0.0 / 0.0))}));
  Vector3 middle;
  const MeshData other = MakeMesh(Ring().vertices, Ring().triangles, middle);
  EXPECT_FALSE(PartsFromBytes(good, other, kMostConvexParts));
  EXPECT_FALSE(PartsFromBytes(good, cup, 8));
}

TEST(KeptPartsTest, WithoutAFolderTheyAreComputed) {
  const TempFolder folder;
  const std::string file = folder.Write("file", "no folder");
  const MeshData cup = CupMesh();
  EXPECT_GT(KeptConvexParts(cup, kMostConvexParts, std::filesystem::path(file) / "below").size(), 4u);
}

}  // namespace
}  // namespace coopdyn
