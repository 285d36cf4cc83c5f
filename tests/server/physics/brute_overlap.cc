// SPDX-License-Identifier: MIT
#include "tests/server/physics/brute_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

/// Adds `direction` unless it, or its opposite, is present.
void AddOnce(std::vector<Vector3>& directions, const Vector3& direction) {
  if (!(direction.squaredNorm() > 1e-20)) return;
  const Vector3 unit = direction.normalized();
  constexpr double kSame = 1 - 1e-9;
  for (const Vector3& one : directions) {
    if (std::abs(one.dot(unit)) > kSame) return;
  }
  directions.push_back(unit);
}

/// Uniformly distributed directions.
const std::vector<Vector3>& AllRound() {
  static const std::vector<Vector3> directions = [] {
    constexpr int kCount = 500;
    std::vector<Vector3> made;
    for (int i = 0; i < kCount; ++i) {
      const double z = 1 - (2.0 * i + 1) / kCount, across = std::sqrt(1 - z * z);
      const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
      made.emplace_back(across * std::cos(turn), across * std::sin(turn), z);
    }
    return made;
  }();
  return directions;
}

/// Descends from `best` to the least overlap.
template <typename Along>
void Refine(const Along& along, BruteOverlap& best, double step) {
  for (int round = 0; step > 1e-5; ++round) {
    const Vector3 side = best.n_W.unitOrthogonal(), other = best.n_W.cross(side);
    const BruteOverlap before = best;
    constexpr int kAround = 8;
    for (int i = 0; i < kAround; ++i) {
      const double turn = (i + 0.37 * round) * 2 * std::numbers::pi / kAround;
      const Vector3 n = (before.n_W + step * (std::cos(turn) * side + std::sin(turn) * other)).normalized();
      const double depth_m = along(n);
      if (depth_m < best.depth_m) best = {depth_m, n};
    }
    if (best.depth_m >= before.depth_m) step /= 2;
  }
}

}  // namespace

BruteSolid::BruteSolid(const Shape& shape, const Pose& X_WS)
    : shape_(shape), X_WS_(X_WS), R_WS_(X_WS.q.toRotationMatrix()) {
  if (std::holds_alternative<Box>(shape)) {
    for (int i = 0; i < 3; ++i) faces_.push_back(Vector3::Unit(i));
    edges_ = faces_;
  } else if (const Mesh* mesh = std::get_if<Mesh>(&shape)) {
    for (const auto& triangle : mesh->data->triangles) {
      std::array<Vector3, 3> p;
      for (std::size_t i = 0; i < 3; ++i) p[i] = mesh->data->vertices[triangle[i]];
      AddOnce(faces_, (p[1] - p[0]).cross(p[2] - p[0]));
      for (std::size_t i = 0; i < 3; ++i) AddOnce(edges_, p[(i + 1) % 3] - p[i]);
    }
  } else if (!std::holds_alternative<Sphere>(shape)) {
    edges_.push_back(Vector3::UnitZ());
    if (std::holds_alternative<Cylinder>(shape)) faces_ = edges_;
  }
}

BruteSolid BruteSolid::Floor() {
  BruteSolid floor;
  floor.is_floor_ = true;
  return floor;
}

double BruteSolid::Reach(const Vector3& direction) const {
  if (is_floor_) return direction.z() > 1 - 1e-12 ? 0 : std::numeric_limits<double>::infinity();
  const double middle = direction.dot(X_WS_.p);
  if (const Sphere* sphere = std::get_if<Sphere>(&shape_)) return middle + sphere->radius_m;
  const Vector3 d = R_WS_.transpose() * direction;
  if (const Box* box = std::get_if<Box>(&shape_)) return middle + d.cwiseAbs().dot(box->size_m) / 2;
  if (const Cylinder* c = std::get_if<Cylinder>(&shape_)) {
    return middle + std::abs(d.z()) * c->length_m / 2 + std::hypot(d.x(), d.y()) * c->radius_m;
  }
  if (const Capsule* c = std::get_if<Capsule>(&shape_)) {
    return middle + std::abs(d.z()) * c->length_m / 2 + c->radius_m;
  }
  double reach = -std::numeric_limits<double>::infinity();
  for (const Vector3& v : std::get<Mesh>(shape_).data->vertices) reach = std::max(reach, v.dot(d));
  return middle + reach;
}

std::vector<Vector3> BruteSolid::faces() const {
  std::vector<Vector3> turned;
  for (const Vector3& one : faces_) turned.push_back(R_WS_ * one);
  return turned;
}

std::vector<Vector3> BruteSolid::edges() const {
  std::vector<Vector3> turned;
  for (const Vector3& one : edges_) turned.push_back(R_WS_ * one);
  return turned;
}

double OverlapAlong(const BruteSolid& a, const BruteSolid& b, const Vector3& n_W) {
  return b.Reach(n_W) + a.Reach(-n_W);
}

BruteOverlap FindOverlap(const BruteSolid& a, const BruteSolid& b) {
  if (b.is_floor()) return {a.Reach(-Vector3::UnitZ()), Vector3::UnitZ()};
  const auto along = [&](const Vector3& n) { return OverlapAlong(a, b, n); };
  std::vector<BruteOverlap> starts;
  const auto start = [&](const Vector3& n) { starts.push_back({along(n), n}); };
  const auto both_ways = [&](const Vector3& n) {
    start(n);
    start(-n);
  };
  for (const Vector3& n : AllRound()) start(n);
  if (!(a.position() - b.position()).isZero()) both_ways((a.position() - b.position()).normalized());
  for (const BruteSolid* solid : {&a, &b}) {
    for (const Vector3& n : solid->faces()) both_ways(n);
  }
  for (const Vector3& one : a.edges()) {
    for (const Vector3& other : b.edges()) {
      const Vector3 n = one.cross(other);
      if (n.squaredNorm() > 1e-12) both_ways(n.normalized());
    }
  }
  constexpr std::size_t kRefined = 10;
  const auto best = starts.begin() + static_cast<std::ptrdiff_t>(std::min(kRefined, starts.size()));
  std::partial_sort(starts.begin(), best, starts.end(),
                    [](const auto& one, const auto& other) { return one.depth_m < other.depth_m; });
  for (auto one = starts.begin(); one != best; ++one) Refine(along, *one, 0.06);
  return *std::ranges::min_element(starts.begin(), best, {}, &BruteOverlap::depth_m);
}

double Outside(const BruteSolid& solid, const Vector3& point) {
  if (solid.is_floor()) return point.z();
  double outside = -std::numeric_limits<double>::infinity();
  const auto look = [&](const Vector3& n) { outside = std::max(outside, n.dot(point) - solid.Reach(n)); };
  for (const Vector3& n : AllRound()) look(n);
  for (const Vector3& n : solid.faces()) {
    look(n);
    look(-n);
  }
  return outside;
}

}  // namespace coopdyn
