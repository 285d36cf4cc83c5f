// SPDX-License-Identifier: MIT
// Meshes against all their triangles, one by one.
#include "server/geometry/ray_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/server/geometry/triangle_soup.h"

namespace coopdyn {
namespace {

TEST(RayTreeTest, RaysMeetWhatTheyMeetOfAllTriangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<> place(-4, 4), aim(-2, 2);
  for (const int count : {1, 5, 300, 2000}) {
    const MeshData mesh = TriangleSoup(random, count);
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
      const Vector3 origin(place(random), place(random), place(random));
      const Vector3 there = i % 10 == 0 ? mesh.vertices[0] : Vector3(aim(random), aim(random), aim(random));
      const Ray ray{origin, i % 7 == 0 ? Vector3(Vector3::UnitY()) : (there - origin).normalized()};
      double nearest = kNoHit;
      for (const auto& [a, b, c] : mesh.triangles) {
        nearest = std::min(nearest, RayToTriangle(ray, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
      }
      EXPECT_EQ(RayToMesh(ray, mesh), nearest) << count << " triangles, ray " << i;
      hits += nearest < kNoHit ? 1 : 0;
    }
    EXPECT_GT(hits, count >= 300 ? 200 : 0) << count << " triangles";
  }
}

}  // namespace
}  // namespace coopdyn
