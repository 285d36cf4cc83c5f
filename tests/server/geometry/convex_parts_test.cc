// SPDX-License-Identifier: MIT
// Concave solids as convex parts.
#include "server/geometry/convex_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "server/base/random.h"
#include "server/geometry/convex_cut.h"
#include "server/geometry/lattice_hull.h"
#include "tests/server/geometry/concave_solids.h"
#include "tests/server/geometry/triangle_soup.h"

namespace coopdyn {
namespace {

struct PlacedHull {
  MeshData hull;
  Vector3 middle = Vector3::Zero();

  /// How far `p` is outside, by the planes of the faces; below 0: inside.
  double Outside(const Vector3& p) const {
    double outside = -1e9;
    for (const auto& [a, b, c] : hull.triangles) {
      const Vector3 &q = hull.vertices[a],
                    n = (hull.vertices[b] - q).cross(hull.vertices[c] - q).normalized();
      outside = std::max(outside, n.dot(p - middle - q));
    }
    return outside;
  }
};

std::vector<PlacedHull> PartsOf(const Triangles& of, int most = kMostConvexParts) {
  std::vector<PlacedHull> made;
  for (const auto& corners : ConvexParts(of.vertices, of.triangles, most)) {
    PlacedHull part;
    auto hull = ConvexHull(corners, part.middle);
    EXPECT_TRUE(hull);
    if (hull) part.hull = *std::move(hull);
    made.push_back(std::move(part));
  }
  return made;
}

double VolumeOf(const std::vector<PlacedHull>& parts) {
  double sum = 0;
  for (const PlacedHull& part : parts) sum += part.hull.volume_m3;
  return sum;
}

double Nearest(const std::vector<PlacedHull>& parts, const Vector3& p) {
  double nearest = 1e9;
  for (const PlacedHull& part : parts) nearest = std::min(nearest, part.Outside(p));
  return nearest;
}

TEST(LatticeHullTest, AllPointsAreInItAndItsVolumeIsExact) {
  LatticeHull cube({0, 0, 0}, {kLatticeSide, 0, 0}, {0, kLatticeSide, 0}, {0, 0, kLatticeSide});
  EXPECT_EQ(cube.volume6(), kLatticeSide * kLatticeSide * kLatticeSide);
  std::mt19937 bits(1);
  // Many points in faces and edges.
  const auto coordinate = [&bits] { return static_cast<std::int64_t>(bits() % 9) * (kLatticeSide / 8); };
  for (int i = 0; i < 2000; ++i) cube.Include({coordinate(), coordinate(), coordinate()});
  EXPECT_EQ(cube.volume6(), 6 * kLatticeSide * kLatticeSide * kLatticeSide);
  const auto corners = cube.Corners();
  for (int i = 0; i < 8; ++i) {
    const LatticePoint corner = {(i & 1) * kLatticeSide, (i >> 1 & 1) * kLatticeSide,
                                 (i >> 2) * kLatticeSide};
    EXPECT_EQ(std::ranges::count(corners, corner), 1);
  }
}

TEST(ConvexPartsTest, WhatIsConvexHasNone) {
  Triangles cube;
  cube.AddBox({0, 0, 0}, {1, 1, 2});
  EXPECT_TRUE(PartsOf(cube).empty());
  EXPECT_TRUE(PartsOf(Turned({{0, -1}, {0.5, -0.86}, {1, 0}, {0.5, 0.86}, {0, 1}}, 24)).empty());
}

TEST(ConvexPartsTest, BlocksAreExact) {
  Triangles angle, chair;
  angle.AddBox({0, 0, 0}, {0.1, 0.3, 0.5});
  angle.AddBox({0.1, 0, 0}, {0.6, 0.3, 0.1});
  chair.AddBox({0, 0, 0.4}, {0.4, 0.4, 0.43});
  for (const double x : {0.0, 0.36}) {
    for (const double y : {0.0, 0.36}) chair.AddBox({x, y, 0}, {x + 0.04, y + 0.04, 0.4});
  }
  chair.AddBox({0, 0.37, 0.43}, {0.4, 0.4, 0.9});
  EXPECT_EQ(PartsOf(angle).size(), 2u);
  EXPECT_EQ(PartsOf(Hook()).size(), 3u);
  EXPECT_EQ(PartsOf(chair).size(), 6u);
  for (const Triangles& solid : {angle, Hook(), chair})
    EXPECT_NEAR(VolumeOf(PartsOf(solid)), solid.Volume(), 1e-2 * solid.Volume());
}

TEST(ConvexPartsTest, ACupIsHollow) {
  const auto parts = PartsOf(Cup());
  ASSERT_GT(parts.size(), 4u);
  ASSERT_LE(parts.size(), 16u);
  // A ball of 3 cm reaches the bottom everywhere near the middle.
  for (double z = 0.0051; z < 0.1; z += 0.003) {
    for (int i = 0; i < 32; ++i) {
      const double angle = 2 * std::numbers::pi * i / 32;
      EXPECT_GT(Nearest(parts, {0.031 * portable::Cos(angle), 0.031 * portable::Sin(angle), z}), 0) << z;
      EXPECT_GT(Nearest(parts, {0.01 * portable::Cos(angle), 0.01 * portable::Sin(angle), z}), 0) << z;
    }
  }
  EXPECT_NEAR(Nearest(parts, {0, 0, 0.01}), 0.005, 1e-5);
  EXPECT_NEAR(Nearest(parts, {0, 0, -0.01}), 0.01, 1e-5);
}

TEST(ConvexPartsTest, ARingIsCoveredAndOpenInTheMiddle) {
  const Triangles ring = Ring();
  const auto parts = PartsOf(ring);
  for (const Vector3& v : ring.vertices) EXPECT_LT(Nearest(parts, v), 0.02);
  EXPECT_GT(Nearest(parts, Vector3::Zero()), 0.6);
  EXPECT_NEAR(VolumeOf(parts), ring.Volume(), 0.08 * ring.Volume());
}

TEST(ConvexPartsTest, ThereAreNoMoreThanAskedForAndNoneOfOne) {
  const auto four = PartsOf(Ring(), 4);
  EXPECT_LE(four.size(), 4u);
  EXPECT_GT(four.size(), 1u);
  EXPECT_TRUE(PartsOf(Ring(), 1).empty());
}

TEST(ConvexPartsTest, PartsHaveFewCorners) {
  for (const auto& corners : ConvexParts(Ring(400).vertices, Ring(400).triangles))
    EXPECT_LE(corners.size(), 60u);
}

TEST(ConvexPartsTest, AnOpenSurfaceIsASheetOfSomeThickness) {
  const auto parts = PartsOf(Turned({{0, 0}, {0.04, 0}, {0.04, 0.1}}, 32));
  ASSERT_GT(parts.size(), 4u);
  EXPECT_GT(Nearest(parts, {0, 0, 0.05}), 0.03);
  EXPECT_LT(Nearest(parts, {0.04, 0, 0.05}), 2e-3);
}

TEST(ConvexPartsTest, TheOrderOfTrianglesDoesNotMatter) {
  Triangles cup = Cup();
  const Triangles same = cup;
  std::ranges::reverse(cup.triangles);
  const auto hulls = PartsOf(cup), before = PartsOf(same);
  ASSERT_EQ(hulls.size(), before.size());
  EXPECT_NEAR(VolumeOf(hulls), VolumeOf(before), 1e-2 * VolumeOf(before));
}

TEST(ConvexPartsTest, HostileMeshesEnd) {
  Triangles two, flat, point, needle, grains, lines;
  two.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  two.triangles = {{0, 1, 2}, {0, 2, 3}};
  flat.AddBox({0, 0, 0}, {1, 1, 0});
  point.AddBox({1, 1, 1}, {1, 1, 1});
  needle.AddBox({0, 0, 0}, {1000, 1e-3, 1e-3});
  needle.AddBox({500, 0, 1e-3}, {500.001, 1e-3, 3e-3});
  for (int i = 0; i < 4000; ++i) {
    const Vector3 p(i * 7919L % 1000 / 1000.0, i * 104729L % 997 / 997.0, i * 1299709L % 991 / 991.0);
    grains.AddBox(p, p + Vector3::Constant(0.01));
  }
  lines.AddBox({0, 0, 0}, {1, 1, 1});
  lines.triangles = {{0, 7, 7}, {1, 6, 1}, {2, 2, 2}};
  std::mt19937 random(3);
  const MeshData soup = TriangleSoup(random, 3000);
  for (const Triangles& one :
       {two, flat, point, needle, grains, lines, Triangles{soup.vertices, soup.triangles}})
    EXPECT_LE(PartsOf(one).size(), 16u);
}

TEST(ConvexPartsTest, TrianglesThroughEachOtherAreGivenUp) {
  Triangles soup;
  std::mt19937 bits(1);
  const auto coordinate = [&bits] { return static_cast<double>(bits() % 1000) / 1000; };
  for (std::uint32_t i = 0; i < 40'000; ++i) {
    for (int k = 0; k < 3; ++k) soup.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const ConvexCut cut = CutConvex(soup.vertices, soup.triangles, kMostConvexParts);
  EXPECT_TRUE(cut.parts.empty());
  EXPECT_TRUE(cut.is_tangled);
}

// The bounding box of each triangle fills all cells.
TEST(ConvexPartsTest, AFineTubeAlongTheDiagonalIsNoTangle) {
  Triangles tube = Turned({{0.1, 0}, {0.1, 2}, {0.09, 2}, {0.09, 0}, {0.1, 0}}, 1000);
  const Quaternion turn = FromRollPitchYaw(0, std::acos(1 / std::sqrt(3.0)), std::numbers::pi / 4);
  for (Vector3& v : tube.vertices) v = turn * v;
  EXPECT_FALSE(CutConvex(tube.vertices, tube.triangles, kMostConvexParts).is_tangled);
}

TEST(ConvexPartsTest, PartsAreTheSameOnEveryMachine) {
  BytesHash hash;
  for (const Triangles& one : {Ring(), Cup(), Hook()}) {
    for (const auto& corners : ConvexParts(one.vertices, one.triangles)) {
      for (const Vector3& corner : corners) hash.Add(corner.data(), 3 * sizeof(double));
    }
  }
  EXPECT_EQ(hash.value(), 13504296561911665808u);
}

}  // namespace
}  // namespace coopdyn
