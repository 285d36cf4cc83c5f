// SPDX-License-Identifier: MIT
#include "server/files/reduce_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace coopdyn {
namespace {

/// A ball of radius 1 m with about `count` triangles.
MeshParts Ball(std::uint32_t count) {
  const auto rings = static_cast<std::uint32_t>(std::sqrt(count / 4.0));
  const std::uint32_t around = 2 * rings;
  MeshParts ball;
  for (std::uint32_t i = 0; i <= rings; ++i) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * k / around;
      ball.vertices.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                 std::cos(theta));
      if (i == 0) continue;
      const std::uint32_t here = i * around + k, next = i * around + (k + 1) % around;
      ball.triangles.push_back({here - around, here, next});
      ball.triangles.push_back({here - around, next, next - around});
    }
  }
  return ball;
}

double VolumeOf(const MeshParts& parts) {
  Vector3 middle = Vector3::Zero();
  return MakeMesh(parts.vertices, parts.triangles, middle).volume_m3;
}

TEST(ReduceMeshTest, ASmallMeshStaysAsItIs) {
  const MeshParts ball = Ball(1000);
  const ReducedMesh reduced = Reduce(ball, 1000);
  EXPECT_EQ(reduced.parts.triangles, ball.triangles);
  EXPECT_EQ(reduced.moved_m, 0);
}

TEST(ReduceMeshTest, ABallKeepsItsVolumeAndSize) {
  const ReducedMesh reduced = Reduce(Ball(100'000), 10'000);
  EXPECT_LE(reduced.parts.triangles.size(), 10'000u);
  EXPECT_GT(reduced.parts.triangles.size(), 3'000u);
  EXPECT_LT(reduced.moved_m, 0.15);
  EXPECT_NEAR(VolumeOf(reduced.parts), 4 * std::numbers::pi / 3, 0.02);
  for (const Vector3& v : reduced.parts.vertices) EXPECT_NEAR(v.norm(), 1, 1e-9);
}

TEST(ReduceMeshTest, TheCornersOfItsBoxStay) {
  // Rough ground: its corners are farthest from the centre, so its hull contains them.
  MeshParts ground;
  constexpr std::uint32_t kSide = 200;
  for (std::uint32_t row = 0; row < kSide; ++row) {
    for (std::uint32_t column = 0; column < kSide; ++column) {
      ground.vertices.emplace_back(row, column, (row * 7 + column * 3) % 5);
      if (row == 0 || column == 0) continue;
      const std::uint32_t here = row * kSide + column;
      ground.triangles.push_back({here - kSide - 1, here - 1, here});
      ground.triangles.push_back({here - kSide - 1, here, here - kSide});
    }
  }
  const MeshParts reduced = Reduce(ground, 5000).parts;
  EXPECT_LE(reduced.triangles.size(), 5000u);
  for (const auto& [x, y] : {std::pair(0, 0), {0, 199}, {199, 0}, {199, 199}}) {
    EXPECT_TRUE(std::ranges::any_of(
        reduced.vertices, [&](const Vector3& v) { return std::hypot(v.x() - x, v.y() - y) < 1e-9; }))
        << x << " " << y;
  }
}

TEST(ReduceMeshTest, MaterialsAndPlacesOnPicturesGoWithTheirCorners) {
  MeshParts ball = Ball(20'000);
  auto skin = std::make_shared<MeshSkin>();
  skin->materials.resize(2);
  for (const Vector3& v : ball.vertices)
    skin->corners.push_back({{static_cast<float>(v.x()), static_cast<float>(v.y())}, v.z() > 0});
  ball.skin = skin;
  const MeshParts reduced = Reduce(std::move(ball), 2000).parts;
  ASSERT_NE(reduced.skin, nullptr);
  ASSERT_EQ(reduced.skin->corners.size(), reduced.vertices.size());
  for (std::size_t i = 0; i < reduced.vertices.size(); ++i) {
    EXPECT_EQ(reduced.skin->corners[i].material, reduced.vertices[i].z() > 0);
    EXPECT_FLOAT_EQ(reduced.skin->corners[i].uv[0], static_cast<float>(reduced.vertices[i].x()));
  }
}

TEST(ReduceMeshTest, OfGrainsThatNoGridHoldsSomeStay) {
  // 10,000 triangles of a micrometre in 10 m: each lies in one cell.
  MeshParts dust;
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const Vector3 p(0.1 * (i % 100), 0.1 * (i / 100), 0);
    for (const Vector3& corner : {Vector3(0, 0, 0), Vector3(1e-6, 0, 0), Vector3(0, 1e-6, 0)})
      dust.vertices.push_back(p + corner);
    dust.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(Reduce(dust, 1000).parts.triangles.size(), 1000u);
}

}  // namespace
}  // namespace coopdyn
