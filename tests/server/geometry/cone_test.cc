// SPDX-License-Identifier: MIT
// The nearest point in a cone: closed forms; meshes against sample points of their triangles; solids against
// the meshes of their surfaces, which another method searches.
#include "server/geometry/cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "tests/server/geometry/triangle_soup.h"

namespace coopdyn::cones {
namespace {

Vector3 Direction(std::mt19937& random) {
  std::normal_distribution<> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

TEST(ConeTest, ASphereIsAsFarAsItsNearestPointInTheCone) {
  const Cone cone{Vector3::Zero(), Vector3::UnitX(), 0.3};
  // Its nearest point lies within.
  const Vector3 within = 2 * Vector3(std::cos(0.2), std::sin(0.2), 0);
  EXPECT_NEAR(NearestInCone({-within, cone.axis, 0.3}, Sphere{0.5}, 5), 1.5, 1e-5);
  // Its nearest point lies beside the cone: the mantle meets it at the smaller root of |r d − m| = R.
  const double beside_rad = 0.4, cosine = std::cos(beside_rad - 0.3);
  const Vector3 beside = 2 * Vector3(std::cos(beside_rad), std::sin(beside_rad), 0);
  const double expected = 2 * cosine - std::sqrt(4 * cosine * cosine - (4 - 0.25));
  EXPECT_NEAR(NearestInCone({-beside, cone.axis, 0.3}, Sphere{0.5}, 5), expected, 1e-5);
  // Out of range, and completely outside.
  EXPECT_EQ(NearestInCone({-within, cone.axis, 0.3}, Sphere{0.5}, 1.4), kNoHit);
  EXPECT_EQ(NearestInCone({{0, -2, 0}, cone.axis, 0.3}, Sphere{0.5}, 5), kNoHit);
}

TEST(ConeTest, AWallAtASlantIsNearestAtTheMantle) {
  // Its face is the plane x = 2; the cone looks 0.5 rad off its normal and opens by 0.2.
  const Cone cone{{-2.05, 0, 0}, {std::cos(0.5), std::sin(0.5), 0}, 0.2};
  EXPECT_NEAR(NearestInCone(cone, Box{{0.1, 20, 20}}, 10), 2 / std::cos(0.3), 1e-5);
}

TEST(ConeTest, AnApexWithinASolidIsAtIt) {
  EXPECT_EQ(NearestInCone({{0.1, 0, 0}, Vector3::UnitX(), 0.1}, Box{{1, 1, 1}}, 5), 0);
}

/// Points on the triangles of `mesh`, at most `spacing_m` apart.
std::vector<Vector3> PointsOn(const MeshData& mesh, double spacing_m) {
  std::vector<Vector3> points;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3 &p = mesh.vertices[a], u = mesh.vertices[b] - p, v = mesh.vertices[c] - p;
    const int count = static_cast<int>(std::ceil(std::max({u.norm(), v.norm(), (u - v).norm()}) / spacing_m));
    for (int i = 0; i <= count; ++i) {
      for (int k = 0; i + k <= count; ++k)
        points.push_back(p + (i * u + k * v) / static_cast<double>(std::max(count, 1)));
    }
  }
  return points;
}

TEST(ConeTest, AMeshIsAsFarAsTheNearestPointOfItsTriangles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<> place(-1.5, 1.5), angle(0.1, 0.8);
  constexpr double kSpacing_m = 0.01;
  int hits = 0;
  for (int round = 0; round < 4; ++round) {
    const MeshData mesh = TriangleSoup(random, 20);
    const std::vector<Vector3> points = PointsOn(mesh, kSpacing_m);
    for (int i = 0; i < 30; ++i) {
      const Cone cone{Vector3(-3, place(random), place(random)),
                      (Vector3::UnitX() + 0.3 * Direction(random)).normalized(), angle(random)};
      // Every point of the mesh is near a sample, which may lie slightly beside the cone.
      double within = kNoHit, around = kNoHit;
      for (const Vector3& p : points) {
        const Vector3 d = p - cone.apex;
        const double distance = d.norm(), along = d.dot(cone.axis) / distance;
        if (distance < within && along >= std::cos(cone.half_angle_rad)) within = distance;
        if (distance < around && along >= std::cos(cone.half_angle_rad + 2 * kSpacing_m / distance))
          around = distance;
      }
      const double nearest = NearestInCone(cone, Mesh{&mesh}, 20);
      EXPECT_LE(nearest, within + 1e-9) << round << " " << i;
      if (nearest < kNoHit) {
        ++hits;
        EXPECT_GE(nearest, around - kSpacing_m) << round << " " << i;
      }
    }
  }
  EXPECT_GT(hits, 80);
}

/// The surface of a solid of revolution about z: `profile` are its r and z from bottom to top.
MeshData Turned(const std::vector<std::pair<double, double>>& profile, std::uint32_t segments) {
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;
  for (const auto& [r, z] : profile) {
    for (std::uint32_t i = 0; i < segments; ++i) {
      const double turn = 2 * M_PI * i / segments;
      vertices.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
  }
  for (std::uint32_t row = 0; row + 1 < profile.size(); ++row) {
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t a = row * segments + i, b = row * segments + (i + 1) % segments;
      triangles.push_back({a, b, b + segments});
      triangles.push_back({a, b + segments, a + segments});
    }
  }
  Vector3 middle;
  return MakeMesh(std::move(vertices), std::move(triangles), middle);
}

MeshData SurfaceOf(const Box& box) {
  std::vector<Vector3> vertices;
  for (int i = 0; i < 8; ++i) {
    const Vector3 side(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    vertices.push_back(side.cwiseProduct(box.size_m / 2));
  }
  Vector3 middle;
  return MakeMesh(std::move(vertices),
                  {{0, 1, 3},
                   {0, 3, 2},
                   {4, 5, 7},
                   {4, 7, 6},
                   {0, 1, 5},
                   {0, 5, 4},
                   {2, 3, 7},
                   {2, 7, 6},
                   {0, 2, 6},
                   {0, 6, 4},
                   {1, 3, 7},
                   {1, 7, 5}},
                  middle);
}
constexpr std::uint32_t kSegments = 400;
MeshData SurfaceOf(const Cylinder& cylinder) {
  const double r = cylinder.radius_m, h = cylinder.length_m / 2;
  return Turned({{0, -h}, {r, -h}, {r, h}, {0, h}}, kSegments);
}
MeshData SurfaceOf(const Capsule& capsule) {
  std::vector<std::pair<double, double>> profile;
  constexpr int kArcs = 100;
  for (const int end : {-1, 1}) {
    for (int i = 0; i <= kArcs; ++i) {
      const double tilt = M_PI / 2 * (end < 0 ? i - kArcs : i) / kArcs;
      profile.emplace_back(capsule.radius_m * std::cos(tilt),
                           end * capsule.length_m / 2 + capsule.radius_m * std::sin(tilt));
    }
  }
  return Turned(profile, kSegments);
}
MeshData SurfaceOf(const Sphere& sphere) {
  return SurfaceOf(Capsule{sphere.radius_m, 0});
}

/// Cones from outside at random, and the same shape as a solid and as a mesh.
template <typename Solid>
void ExpectAsFarAsItsSurface(std::mt19937& random, const std::function<Solid()>& make) {
  std::uniform_real_distribution<> place(-1.5, 1.5), angle(0.05, 0.8);
  int hits = 0, at_mantle = 0;
  for (int round = 0; round < 3; ++round) {
    const Solid solid = make();
    const MeshData surface = SurfaceOf(solid);
    for (int i = 0; i < 60; ++i) {
      const Cone cone{Vector3(-2, place(random), place(random)),
                      (Vector3::UnitX() + 0.4 * Direction(random)).normalized(), angle(random)};
      const double as_solid = NearestInCone(cone, solid, 20);
      const double as_mesh = NearestInCone(cone, Mesh{&surface}, 20);
      // A faceted surface lies slightly inside: the cone may pass between the two.
      if ((as_solid < kNoHit) != (as_mesh < kNoHit)) {
        Cone narrower = cone;
        narrower.half_angle_rad -= 1e-3;
        EXPECT_EQ(NearestInCone(narrower, solid, 20), kNoHit) << round << " " << i;
        continue;
      }
      if (as_solid == kNoHit) continue;
      ++hits;
      Cone wider = cone;
      wider.half_angle_rad += 0.05;
      at_mantle += NearestInCone(wider, solid, 20) < as_solid - 1e-3 ? 1 : 0;
      EXPECT_NEAR(as_solid, as_mesh, 1e-3) << round << " " << i;
    }
  }
  EXPECT_GT(hits, 60);
  EXPECT_GT(at_mantle, 10);  // cases in which the shape's nearest point is outside the cone
}

TEST(ConeTest, ABoxIsAsFarAsItsSurface) {
  std::mt19937 random(7);
  std::uniform_real_distribution<> size(0.2, 1.2);
  ExpectAsFarAsItsSurface<Box>(random, [&] { return Box{{size(random), size(random), size(random)}}; });
}
TEST(ConeTest, ACylinderIsAsFarAsItsSurface) {
  std::mt19937 random(8);
  std::uniform_real_distribution<> size(0.2, 0.8);
  ExpectAsFarAsItsSurface<Cylinder>(random, [&] { return Cylinder{size(random), size(random)}; });
}
TEST(ConeTest, ACapsuleIsAsFarAsItsSurface) {
  std::mt19937 random(9);
  std::uniform_real_distribution<> size(0.2, 0.6);
  ExpectAsFarAsItsSurface<Capsule>(random, [&] { return Capsule{size(random), size(random)}; });
}
TEST(ConeTest, ASphereIsAsFarAsItsSurface) {
  std::mt19937 random(10);
  std::uniform_real_distribution<> size(0.2, 0.8);
  ExpectAsFarAsItsSurface<Sphere>(random, [&] { return Sphere{size(random)}; });
}

}  // namespace
}  // namespace coopdyn::cones
