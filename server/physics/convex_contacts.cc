// SPDX-License-Identifier: MIT
#include "server/physics/convex_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "server/base/portable_math.h"
#include "server/geometry/convex_overlap.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

Vector3 FurthestPoint(const Mesh& mesh, const Vector3& direction) {
  return *std::ranges::max_element(mesh.data->vertices, {},
                                   [&](const Vector3& v) { return v.dot(direction); });
}

/// The point of a part that lies furthest along `n_W`.
Vector3 Furthest(const PlacedPart& part, const Vector3& n_W) {
  const PlacedRotation place = part.place();
  const Vector3 local(n_W.dot(place.axis(0)), n_W.dot(place.axis(1)), n_W.dot(place.axis(2)));
  return place.point(
      std::visit([&](const auto& shape) { return FurthestPoint(shape, local); }, part.part->shape));
}

/// The set of differences of points of B and A, which contains the origin if the two overlap. Expands a
/// polytope towards the point of the set's surface nearest to the origin (the expanding polytope algorithm,
/// van den Bergen 2001). At first the polytope may not contain the origin.
class MinkowskiDifference {
 public:
  /// `margin_m`: rounds the set off, so that it contains the origin also across this gap.
  MinkowskiDifference(const PlacedPart& a, const PlacedPart& b, double margin_m)
      : a_(a), b_(b), margin_m_(margin_m) {}

  Separation Find() {
    if (!Begin()) return least_;
    constexpr int kMostSteps = 100;
    for (int step = 0; step < kMostSteps; ++step) {
      const Face& nearest = *std::ranges::min_element(faces_, {}, &Face::height_m);
      const double height_m = nearest.height_m;
      const Difference p = Look(nearest.n);
      if (least_.depth_m <= 0) return least_;
      if (last_m_ - height_m < kNear_m) break;
      Include(p);
      // Rounding may remove faces that leave it open. Then it would grow without end, and least_ holds.
      if (faces_.size() > 2 * points_.size()) break;
    }
    least_.p_W = Middle();
    return least_;
  }

 private:
  static constexpr double kNear_m = 1e-7;

  struct Difference {
    Vector3 p, middle_W;
  };
  struct Face {
    std::array<std::uint32_t, 3> corners;
    Vector3 n = Vector3::Zero();
    double height_m = std::numeric_limits<double>::infinity();  // of the plane above the origin
  };

  /// The difference that lies furthest along `n`. Each one is an upper bound of the depth.
  Difference Look(const Vector3& n) {
    const Vector3 of_a = Furthest(a_, -n), of_b = Furthest(b_, n);
    const Vector3 p = of_b - of_a + margin_m_ * n;
    last_m_ = n.dot(p);
    if (last_m_ < least_.depth_m) least_ = {last_m_, n};
    return {p, (of_a + of_b) / 2};
  }

  /// Begins with a tetrahedron. Returns false if A and B are apart.
  bool Begin() {
    const Vector3 between = a_.place().position() - b_.place().position();
    const Vector3 n = between.squaredNorm() > 0 ? between.normalized() : Vector3(Vector3::UnitZ());
    points_ = {Look(n), Look(-n)};
    if (least_.depth_m <= 0) return false;
    const Vector3 along = (points_[0].p - points_[1].p).normalized();
    const Vector3 side = along.unitOrthogonal(), other = along.cross(side);
    AddFurthest<4>({side, -side, other, -other},
                   [&](const Vector3& p) { return along.cross(p - points_[0].p).norm(); });
    const Vector3 up = along.cross(points_[2].p - points_[0].p).normalized();
    AddFurthest<2>({up, -up}, [&](const Vector3& p) { return std::abs(up.dot(p - points_[0].p)); });
    if (least_.depth_m <= 0) return false;
    const bool is_left = up.dot(points_[3].p - points_[0].p) > 0;
    const std::array<std::array<std::uint32_t, 3>, 4> all{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    for (auto corners : all) {
      if (!is_left) std::swap(corners[1], corners[2]);
      Add(corners);
    }
    return true;
  }

  template <std::size_t N, typename Measure>
  void AddFurthest(const std::array<Vector3, N>& directions, const Measure& measure) {
    Difference best;
    double most = -1;
    for (const Vector3& n : directions) {
      const Difference p = Look(n);
      if (measure(p.p) <= most) continue;
      most = measure(p.p);
      best = p;
    }
    points_.push_back(best);
  }

  void Add(const std::array<std::uint32_t, 3>& corners) {
    Face face{corners};
    const Vector3& p = points_[corners[0]].p;
    const Vector3 n = (points_[corners[1]].p - p).cross(points_[corners[2]].p - p);
    constexpr double kNoArea_m2 = 1e-16;
    if (n.norm() > kNoArea_m2) {
      face.n = n.normalized();
      face.height_m = face.n.dot(p);
    }
    faces_.push_back(face);
  }

  /// The midpoint of the two points whose difference is nearest to the origin.
  Vector3 Middle() const {
    const double height_m = std::ranges::min_element(faces_, {}, &Face::height_m)->height_m;
    Vector3 middle_W = Vector3::Zero();
    double least = -std::numeric_limits<double>::infinity();
    for (const Face& face : faces_) {
      // A flat side may consist of several triangles: the one below the origin counts.
      if (face.height_m > height_m + kNear_m) continue;
      const auto corner = [&](std::size_t i) -> const Difference& { return points_[face.corners[i % 3]]; };
      const Vector3 nearest = face.height_m * face.n;
      Vector3 shares;
      for (std::size_t i = 0; i < 3; ++i)
        shares[static_cast<Eigen::Index>(i)] =
            face.n.dot((corner(i + 1).p - nearest).cross(corner(i + 2).p - nearest));
      shares /= shares.sum();
      if (!(shares.minCoeff() > least)) continue;
      least = shares.minCoeff();
      shares = shares.cwiseMax(0);
      middle_W = Vector3::Zero();
      for (std::size_t i = 0; i < 3; ++i)
        middle_W += shares[static_cast<Eigen::Index>(i)] / shares.sum() * corner(i).middle_W;
    }
    return middle_W;
  }

  void Include(const Difference& p) {
    constexpr double kRounding_m = 1e-12;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::erase_if(faces_, [&](const Face& face) {
      if (!(face.n.dot(p.p) > face.height_m + kRounding_m)) return false;
      for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(face.corners[i], face.corners[(i + 1) % 3]);
      return true;
    });
    const auto number = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    for (const auto& [from, to] : edges) {
      if (std::ranges::find(edges, std::pair(to, from)) == edges.end()) Add({from, to, number});
    }
  }

  const PlacedPart &a_, &b_;
  const double margin_m_;
  Separation least_{std::numeric_limits<double>::infinity()};
  double last_m_ = 0;
  std::vector<Difference> points_;
  std::vector<Face> faces_;
};

using Patch = std::vector<Vector3>;

// Faces and edges within this angle (rad) touch along their whole extent.
constexpr double kLean = 0.02;

/// The corner, the ends of the edge, or the outline of the face (in order) of a part that faces along `n_W`.
Patch PatchOf(const PlacedPart& part, const Vector3& n_W) {
  const PlacedRotation place = part.place();
  const Vector3 axis = place.axis(2), side = n_W.unitOrthogonal(), other = n_W.cross(side);
  constexpr int kAround = 16;
  const auto leaning = [&](int i, double lean) {
    const double turn = (i + 0.5) * 2 * std::numbers::pi / kAround;
    const auto [sine, cosine] = portable::SinCos(turn);
    return Vector3(n_W + lean * (cosine * side + sine * other));
  };
  const Cylinder* cylinder = std::get_if<Cylinder>(&part.part->shape);
  const Capsule* capsule = std::get_if<Capsule>(&part.part->shape);
  const double along = n_W.dot(axis);
  if ((cylinder || capsule) && std::abs(along) < kLean) {
    const Vector3 half = (cylinder ? cylinder->length_m : capsule->length_m) / 2 * axis;
    const double radius_m = cylinder ? cylinder->radius_m : capsule->radius_m;
    const Vector3 middle = place.position() + radius_m * (n_W - along * axis).normalized();
    return {middle - half, middle + half};
  }
  if (std::holds_alternative<Sphere>(part.part->shape) || capsule ||
      (cylinder && std::abs(along) < portable::Cos(kLean)))
    return {Furthest(part, n_W)};
  Patch patch;
  patch.reserve(kAround);
  for (int i = 0; i < kAround; ++i) {
    // A cylinder's end leans less than kLean here.
    const Vector3 p = Furthest(part, leaning(i, cylinder ? 2 * kLean : kLean));
    constexpr double kSame_m = 1e-9;
    const auto is_new = [&](const Vector3& q) { return (p - q).squaredNorm() > kSame_m * kSame_m; };
    if (patch.empty() || (is_new(patch.back()) && is_new(patch.front()))) patch.push_back(p);
  }
  return patch;
}

/// Points of the rim of a leaning cylinder's end that faces along `n_W`: the furthest, and those at each
/// quarter turn from it. Empty if the part is another shape.
Patch RimOf(const PlacedPart& part, const Vector3& n_W) {
  const Cylinder* cylinder = std::get_if<Cylinder>(&part.part->shape);
  if (cylinder == nullptr) return {};
  const PlacedRotation place = part.place();
  const Vector3 axis = (n_W.dot(place.axis(2)) < 0 ? -1 : 1) * place.axis(2);
  const Vector3 furthest = cylinder->radius_m * (n_W - n_W.dot(axis) * axis).normalized();
  const Vector3 middle = place.position() + cylinder->length_m / 2 * axis, side = axis.cross(furthest);
  return {middle + furthest, middle + side, middle - furthest, middle - side};
}

/// The part of `patch` within the outline `within`, seen along `n`.
Patch Clipped(Patch patch, const Patch& within, const Vector3& n) {
  Patch kept;
  kept.reserve(patch.size() + within.size());
  for (std::size_t i = 0; i < within.size() && !patch.empty(); ++i) {
    const Vector3& from = within[i];
    const Vector3 inward = n.cross(within[(i + 1) % within.size()] - from);
    const auto height = [&](const Vector3& p) { return inward.dot(p - from); };
    kept.clear();
    const std::size_t sides = patch.size() == 2 ? 1 : patch.size();
    if (sides == 1 && height(patch[0]) >= 0) kept.push_back(patch[0]);
    for (std::size_t k = 0; k < sides; ++k) {
      const Vector3 &p = patch[k], &q = patch[(k + 1) % patch.size()];
      const double of_p = height(p), of_q = height(q);
      if (patch.size() > 1 && (of_p < 0) != (of_q < 0)) kept.push_back(p + of_p / (of_p - of_q) * (q - p));
      if (patch.size() > 1 && of_q >= 0) kept.push_back(q);
    }
    std::swap(patch, kept);
  }
  return patch;
}

/// Twice the area of an outline, as a vector.
Vector3 AreaOf(const Patch& outline) {
  Vector3 area = Vector3::Zero();
  for (std::size_t i = 2; i < outline.size(); ++i)
    area += (outline[i - 1] - outline[0]).cross(outline[i] - outline[0]);
  return area;
}

/// Two edges that cross, or run along each other: points of the first, and the height of the second above
/// them.
std::vector<std::pair<Vector3, double>> EdgesMeet(const Patch& one, const Patch& other, const Vector3& n) {
  const auto flat = [&](const Vector3& v) { return Vector3(v - n.dot(v) * n); };
  const Vector3 d = one[1] - one[0], e = other[1] - other[0], between = other[0] - one[0];
  const Vector3 d_flat = flat(d), e_flat = flat(e);
  const double dd = d_flat.squaredNorm(), ee = e_flat.squaredNorm();
  if (!(dd > 0) || !(ee > 0)) return {};
  const double crossing = n.dot(d_flat.cross(e_flat));
  std::vector<std::pair<Vector3, double>> met;
  const auto meet = [&](double s) {
    const Vector3 p = one[0] + std::clamp(s, 0.0, 1.0) * d;
    const double t = std::clamp(flat(p - other[0]).dot(e_flat) / ee, 0.0, 1.0);
    met.emplace_back(p, n.dot(other[0] + t * e - p));
  };
  if (std::abs(crossing) > kLean * std::sqrt(dd * ee)) {
    meet(n.dot(between.cross(e_flat)) / crossing);
  } else {
    double from = flat(between).dot(d_flat) / dd, to = flat(other[1] - one[0]).dot(d_flat) / dd;
    if (from > to) std::swap(from, to);
    if (to < 0 || from > 1) return {};
    meet(from);
    meet(to);
  }
  return met;
}

/// Points of `one`, and the height of `other` above them along `n`. Empty if `other` leans too far or does
/// not overlap.
std::vector<std::pair<Vector3, double>> Meet(const Patch& one, const Patch& other, const Vector3& n) {
  std::vector<std::pair<Vector3, double>> met;
  if (one.size() == 2 && other.size() == 2) return EdgesMeet(one, other, n);
  if (other.size() < 3) return met;
  Vector3 area = AreaOf(other);
  const double seen = n.dot(area);
  if (std::abs(seen) < 0.5 * area.norm()) return met;
  for (const Vector3& p : Clipped(one, other, seen < 0 ? Vector3(-n) : n))
    met.emplace_back(p, area.dot(other[0] - p) / seen);
  return met;
}

}  // namespace

double OverlapAlong(const PlacedPart& a, const PlacedPart& b, const Vector3& n_W) {
  return n_W.dot(Furthest(b, n_W) - Furthest(a, -n_W));
}

Separation FindSeparation(const PlacedPart& a, const PlacedPart& b, double margin_m) {
  Separation least = MinkowskiDifference(a, b, margin_m).Find();
  least.depth_m -= margin_m;
  return least;
}

std::vector<ContactPoint> ContactsAlong(const PlacedPart& a, const PlacedPart& b, const Separation& least,
                                        double margin_m) {
  const Vector3& n = least.n_W;
  Patch of_a = PatchOf(a, -n), of_b = PatchOf(b, n);
  // A disc that wobbles on a face is held where it will touch next, too.
  const auto add_rim = [](Patch& patch, const PlacedPart& part, const Vector3& n_W, const Patch& other) {
    if (patch.size() != 1 || other.size() < 3) return;
    if (Patch rim = RimOf(part, n_W); !rim.empty()) patch = std::move(rim);
  };
  add_rim(of_a, a, -n, of_b);
  add_rim(of_b, b, n, of_a);
  // The outline with fewer corners clips the other; a corner or an edge clips nothing.
  const bool is_b_larger = of_a.size() < of_b.size();
  const bool swap = std::min(of_a.size(), of_b.size()) < 3 ? !is_b_larger : is_b_larger;
  const double sign = swap ? -1 : 1;
  std::vector<ContactPoint> contacts;
  double deepest_m = -std::numeric_limits<double>::infinity();
  for (const auto& [p, above_m] : swap ? Meet(of_b, of_a, n) : Meet(of_a, of_b, n)) {
    contacts.push_back({p + above_m / 2 * n, n, sign * above_m});
    deepest_m = std::max(deepest_m, sign * above_m);
  }
  // Corners and ends are rounded off: make the deepest contact as deep as `least`.
  for (ContactPoint& one : contacts) one.depth_m += least.depth_m - deepest_m;
  std::erase_if(contacts, [&](const ContactPoint& one) { return one.depth_m < -margin_m; });
  if (contacts.empty()) contacts.push_back({least.p_W, n, least.depth_m});
  return contacts;
}

}  // namespace coopdyn
