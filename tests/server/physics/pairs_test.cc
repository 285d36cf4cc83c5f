// SPDX-License-Identifier: MIT
// Each pair of kinds of shapes, a thousand times: if brute force finds an overlap, there are contacts that
// separate the shapes; if it finds a gap, there are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "server/geometry/mesh.h"
#include "server/physics/contacts.h"
#include "server/physics/convex_contacts.h"
#include "tests/server/physics/brute_overlap.h"

namespace coopdyn {
namespace {

constexpr double kHeld_m = 1e-3;
constexpr double kWholeTurn_rad = 2 * std::numbers::pi;

enum class ShapeKind { kBox, kCylinder, kSphere, kCapsule, kHull, kFloor };
const char* NameOf(ShapeKind kind) {
  constexpr std::array<const char*, 6> kNames{"Box", "Cylinder", "Sphere", "Capsule", "Hull", "Floor"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// Shapes and poses, typical ones of scenarios and random ones.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}

  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  int Of(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

  Vector3 Direction() {
    Vector3 v = Vector3::Zero();
    while (v.norm() < 0.1 || v.norm() > 1) v = {Between(-1, 1), Between(-1, 1), Between(-1, 1)};
    return v.normalized();
  }
  Quaternion AnyRotation() { return Quaternion(Eigen::AngleAxisd(Between(0, kWholeTurn_rad), Direction())); }
  /// Integer degrees about some axes.
  Quaternion TidyRotation() {
    const auto angle = [&] { return Of(2) == 0 ? 0 : (Of(2) == 0 ? 5 : 90) * Of(72) * kWholeTurn_rad / 360; };
    return FromRollPitchYaw(angle(), angle(), angle());
  }
  Quaternion QuarterTurns() {
    return FromRollPitchYaw(Of(4) * kWholeTurn_rad / 4, Of(4) * kWholeTurn_rad / 4,
                            Of(4) * kWholeTurn_rad / 4);
  }
  /// Zero, or one of 1e-16 to 1e-6 rad.
  Quaternion TinyRotation() {
    if (Of(3) == 0) return Quaternion::Identity();
    return Quaternion(Eigen::AngleAxisd(std::pow(10, Between(-16, -6)), Direction()));
  }

  double Length() { return Of(2) == 0 ? 0.1 * (1 + Of(8)) : Between(0.05, 0.8); }
  Shape Make(ShapeKind kind) {
    switch (kind) {
      case ShapeKind::kBox:
        return Box{{Length(), Length(), Length()}};
      case ShapeKind::kCylinder:
        return Cylinder{Length() / 2, Length()};
      case ShapeKind::kSphere:
        return Sphere{Length() / 2};
      case ShapeKind::kCapsule:
        return Capsule{Length() / 2, Length()};
      default:
        return Mesh{meshes_[static_cast<std::size_t>(Of(static_cast<int>(meshes_.size())))].get()};
    }
  }

 private:
  static std::vector<std::unique_ptr<const MeshData>> MakeMeshes();

  std::mt19937_64 engine_;
  const std::vector<std::unique_ptr<const MeshData>> meshes_ = MakeMeshes();
};

std::vector<std::unique_ptr<const MeshData>> Dice::MakeMeshes() {
  std::vector<std::unique_ptr<const MeshData>> made;
  const auto add = [&](const std::vector<Vector3>& points) {
    Vector3 middle;
    auto hull = ConvexHull(points, middle);
    if (hull) made.push_back(std::make_unique<const MeshData>(std::move(*hull)));
  };
  std::mt19937_64 engine(7);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  for (int i = 0; i < 10; ++i) {
    std::vector<Vector3> block, prism, cloud;
    const Vector3 half(between(0.05, 0.4), between(0.05, 0.4), between(0.05, 0.4));
    for (int corner = 0; corner < 8; ++corner) {
      block.emplace_back(corner & 1 ? half.x() : -half.x(), corner & 2 ? half.y() : -half.y(),
                         corner & 4 ? half.z() : -half.z());
      cloud.emplace_back(between(-0.4, 0.4), between(-0.4, 0.4), between(-0.4, 0.4));
    }
    const int corners = 3 + i % 6;
    for (int corner = 0; corner < corners; ++corner) {
      const double turn = corner * kWholeTurn_rad / corners;
      for (const double z : {-half.z(), half.z()})
        prism.emplace_back(half.x() * std::cos(turn), half.x() * std::sin(turn), z);
    }
    add(block);
    add(prism);
    add(cloud);
  }
  return made;
}

/// The least displacement that satisfies all contacts.
Vector3 WayOf(const ContactList& list) {
  Vector3 way = Vector3::Zero();
  for (int round = 0; round < 200; ++round) {
    double most = 0;
    for (const ContactPoint& one : list.all()) {
      double left = one.depth_m - one.n_W.dot(way);
      if (left > 0) way += left * one.n_W;
      most = std::max(most, left);
    }
    if (most < 1e-9) break;
  }
  return way;
}

BodyState StateAt(const Pose& pose) {
  BodyState state;
  state.p_WB = pose.p;
  state.q_WB = {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
  const Matrix3 R = pose.q.toRotationMatrix();
  for (int i = 0; i < 9; ++i) state.R_WB[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
  return state;
}

/// Two shapes, and their overlap by brute force.
struct Pair {
  Part part_a, part_b;
  Pose X_WA, X_WB;
  BruteSolid a, b;
  BruteOverlap truth;
};

/// Two shapes that overlap or miss each other by some millimetres.
Pair MakePair(Dice& dice, ShapeKind kind_a, ShapeKind kind_b) {
  const bool on_floor = kind_b == ShapeKind::kFloor, is_tidy = dice.Of(5) < 3;
  Part part_a, part_b;
  part_a.shape = dice.Make(kind_a);
  part_b.shape = dice.Make(kind_b);
  Pose X_WA, X_WB;
  if (!on_floor) {
    X_WB.q = is_tidy ? dice.TidyRotation() : dice.AnyRotation();
    X_WB.p = {dice.Between(-3, 3), dice.Between(-3, 3), dice.Between(0, 3)};
  }
  X_WA.q = is_tidy ? (X_WB.q * dice.QuarterTurns() * dice.TinyRotation()).normalized() : dice.AnyRotation();
  const BruteSolid b = on_floor ? BruteSolid::Floor() : BruteSolid(part_b.shape, X_WB);
  // Mostly they meet along a face of B.
  Vector3 n = on_floor ? Vector3::UnitZ() : dice.Direction();
  const std::vector<Vector3> faces = b.faces();
  if (!faces.empty() && dice.Of(4) != 0) {
    n = (dice.Of(2) == 0 ? 1 : -1) * faces[static_cast<std::size_t>(dice.Of(static_cast<int>(faces.size())))];
  }
  const double aside_m = dice.Of(4) == 0 ? 0 : dice.Between(0, 0.6);
  X_WA.p = X_WB.p + aside_m * n.cross(dice.Direction());
  X_WA.p += OverlapAlong(BruteSolid(part_a.shape, X_WA), b, n) * n;
  const double wanted_m = dice.Of(4) == 0   ? dice.Between(-0.006, 0)
                          : dice.Of(4) == 0 ? dice.Between(0, 0.05)
                                            : dice.Between(0, 0.008);
  BruteOverlap truth = FindOverlap(BruteSolid(part_a.shape, X_WA), b);
  for (int step = 0; step < 4 && std::abs(truth.depth_m - wanted_m) > 1e-4 && truth.depth_m < 1e-4; ++step) {
    X_WA.p += (truth.depth_m - wanted_m) * truth.n_W;
    truth = FindOverlap(BruteSolid(part_a.shape, X_WA), b);
  }
  return {part_a, part_b, X_WA, X_WB, BruteSolid(part_a.shape, X_WA), b, truth};
}

/// The overlap of two shapes after A has moved by `way_m`.
double LeftAfter(const Pair& pair, const Vector3& way_m) {
  BruteSolid moved = pair.a;
  moved.MoveBy(way_m);
  const double left_m = OverlapAlong(moved, pair.b, pair.truth.n_W);
  return left_m > kHeld_m ? FindOverlap(moved, pair.b).depth_m : left_m;
}

struct Kinds {
  ShapeKind a, b;
};
void PrintTo(const Kinds& kinds, std::ostream* out) {
  *out << NameOf(kinds.a) << " and " << NameOf(kinds.b);
}

class PairsTest : public testing::TestWithParam<Kinds> {};

TEST_P(PairsTest, ContactsAreWhereBruteForceSaysThatTheyTouchAndPartThem) {
  const auto [kind_a, kind_b] = GetParam();
  Dice dice(100 * static_cast<std::uint64_t>(kind_a) + static_cast<std::uint64_t>(kind_b));
  Collider collider;
  int overlapping = 0, apart = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Pair pair = MakePair(dice, kind_a, kind_b);
    const PlacedPart a(pair.part_a, StateAt(pair.X_WA)), b(pair.part_b, StateAt(pair.X_WB));
    const ContactList list =
        kind_b == ShapeKind::kFloor ? CollideFloor(collider, a, 0) : Collide(collider, a, b, 0);
    const double depth_m = pair.truth.depth_m;
    if (depth_m < -kHeld_m) {
      ++apart;
      EXPECT_EQ(list.count, 0) << "apart by " << -depth_m;
    }
    if (depth_m < kHeld_m) continue;
    ++overlapping;
    EXPECT_GT(list.count, 0) << "overlap by " << depth_m;
    const Vector3 way_m = WayOf(list);
    EXPECT_LT(LeftAfter(pair, way_m), kHeld_m) << "overlap by " << depth_m << ", pushed by " << way_m.norm();
    // Deep inside a box, ODE pushes a capsule somewhat farther.
    EXPECT_LT(way_m.norm(), 1.1 * depth_m + kHeld_m);
    for (const ContactPoint& one : list.all()) {
      EXPECT_LT(std::max(Outside(pair.a, one.p_W), Outside(pair.b, one.p_W)), depth_m + kHeld_m);
    }
  }
  EXPECT_GT(overlapping, 500);
  EXPECT_GT(apart, 100);
}

std::vector<Kinds> AllKinds() {
  constexpr int kFloor = static_cast<int>(ShapeKind::kFloor);
  std::vector<Kinds> all;
  for (int a = 0; a < kFloor; ++a) {
    for (int b = a; b <= kFloor; ++b) all.push_back({static_cast<ShapeKind>(a), static_cast<ShapeKind>(b)});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(OfEachTwoKinds, PairsTest, testing::ValuesIn(AllKinds()), [](const auto& info) {
  return std::string(NameOf(info.param.a)) + NameOf(info.param.b);
});

TEST(Separation, OfARimThatLiesNearlyFlatInATallWallEnds) {
  // Rounding once left the polytope open here: each point added a tenth more faces, and the search took
  // minutes.
  Part rim, wall;
  rim.shape = Cylinder{0.03, 0.015};
  wall.shape = Box{Vector3(0.1, 2, 1.5)};
  BodyState origin{};
  origin.R_WB = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  origin.q_WB = {1, 0, 0, 0};
  PlacedPart a(rim, origin), b(wall, origin);
  const std::array<double, 12> R{0.99885766845897472,
                                 0.047784497074898138,
                                 2.8589842299142632e-11,
                                 0,
                                 -2.2854097087021685e-11,
                                 -1.2058005993426796e-10,
                                 1,
                                 0,
                                 0.047784497074898138,
                                 -0.99885766845897472,
                                 -1.1935024604899092e-10,
                                 0};
  const std::array<double, 3> p{-1.0015639673961167, -0.055000000031959054, 0.026395569275625523};
  std::ranges::copy(R, std::begin(a.R));
  std::ranges::copy(p, std::begin(a.p));
  b.p[0] = -1;
  b.p[2] = 0.75;
  const Separation separation = FindSeparation(a, b, 0);
  EXPECT_NEAR(separation.depth_m, 0.0564, 1e-3);
  EXPECT_LT(separation.n_W.z(), -0.999);
}

}  // namespace
}  // namespace coopdyn
