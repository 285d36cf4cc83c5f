// SPDX-License-Identifier: MIT
#include "server/physics/box_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace coopdyn {

namespace {

// An edge must beat a face by this much: otherwise a stacked box would occasionally rest on one point.
constexpr double kFaceFirst_m = 5e-5;

struct PlacedBox {
  PlacedBox(const Box& box, const PlacedRotation& X_WB) : half_m(box.size_m / 2), p_W(X_WB.position()) {
    for (int i = 0; i < 3; ++i) axes_W.col(i) = X_WB.axis(i);
  }
  /// Distance from the centre to the furthest point along a direction.
  double Reach(const Vector3& n_W) const { return (axes_W.transpose() * n_W).cwiseAbs().dot(half_m); }

  Vector3 half_m, p_W;
  Matrix3 axes_W;
};

/// A convex polygon. Faces have 4 corners, and each cut adds at most one.
class Outline {
 public:
  void Add(const Vector3& p) { points_[count_++] = p; }
  /// The part below `most` along `n`.
  Outline Cut(const Vector3& n, double most) const {
    Outline kept;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vector3 &p = points_[i], &q = points_[(i + 1) % count_];
      const double of_p = n.dot(p) - most, of_q = n.dot(q) - most;
      if (of_p <= 0) kept.Add(p);
      if ((of_p < 0 && of_q > 0) || (of_p > 0 && of_q < 0)) kept.Add(p + of_p / (of_p - of_q) * (q - p));
    }
    return kept;
  }
  auto begin() const { return points_.begin(); }
  auto end() const { return points_.begin() + static_cast<std::ptrdiff_t>(count_); }

 private:
  std::array<Vector3, 12> points_;
  std::size_t count_ = 0;
};

/// The face of `box` whose outward normal is most opposed to `n_W`.
Outline FaceAgainst(const PlacedBox& box, const Vector3& n_W) {
  const Vector3 n = box.axes_W.transpose() * n_W;
  int face = 0;
  n.cwiseAbs().maxCoeff(&face);
  const int i = (face + 1) % 3, k = (face + 2) % 3;
  const Vector3 middle = box.p_W + (n[face] > 0 ? -1 : 1) * box.half_m[face] * box.axes_W.col(face);
  const Vector3 u = box.half_m[i] * box.axes_W.col(i), v = box.half_m[k] * box.axes_W.col(k);
  Outline outline;
  outline.Add(middle + u + v);
  outline.Add(middle - u + v);
  outline.Add(middle - u - v);
  outline.Add(middle + u - v);
  return outline;
}

/// Points of `other` over the face `axis` of `box` with outward normal `n_W`. The contacts' normal is `sign`
/// times `n_W`.
std::vector<ContactPoint> AcrossFace(const PlacedBox& box, int axis, const Vector3& n_W,
                                     const PlacedBox& other, double sign, double margin_m) {
  Outline outline = FaceAgainst(other, n_W);
  for (const int side : {(axis + 1) % 3, (axis + 2) % 3}) {
    const Vector3 u = box.axes_W.col(side);
    outline = outline.Cut(u, u.dot(box.p_W) + box.half_m[side]);
    outline = outline.Cut(-u, -u.dot(box.p_W) + box.half_m[side]);
  }
  std::vector<ContactPoint> points;
  const double top = n_W.dot(box.p_W) + box.half_m[axis];
  for (const Vector3& p : outline) {
    const double depth_m = top - n_W.dot(p);
    if (depth_m > -margin_m) points.push_back({p + depth_m / 2 * n_W, sign * n_W, depth_m});
  }
  return points;
}

/// The contact point of an edge of A and an edge of B; `n_W`: from B to A.
ContactPoint AcrossEdges(const PlacedBox& a, int edge_a, const PlacedBox& b, int edge_b, const Vector3& n_W,
                         double depth_m) {
  const auto middle = [](const PlacedBox& box, int edge, const Vector3& towards) {
    Vector3 p = box.p_W;
    for (int i = 0; i < 3; ++i) {
      if (i == edge) continue;
      p += (box.axes_W.col(i).dot(towards) > 0 ? 1 : -1) * box.half_m[i] * box.axes_W.col(i);
    }
    return p;
  };
  const Vector3 p = middle(a, edge_a, -n_W), q = middle(b, edge_b, n_W);
  const Vector3 u = a.axes_W.col(edge_a), v = b.axes_W.col(edge_b);
  // The points where the two lines are nearest to each other.
  const double uv = u.dot(v), of_u = u.dot(q - p), of_v = v.dot(q - p);
  const double apart = 1 - uv * uv;
  const Vector3 on_a = p + std::clamp((of_u - uv * of_v) / apart, -a.half_m[edge_a], a.half_m[edge_a]) * u;
  const Vector3 on_b = q + std::clamp((uv * of_u - of_v) / apart, -b.half_m[edge_b], b.half_m[edge_b]) * v;
  return {(on_a + on_b) / 2, n_W, depth_m};
}

}  // namespace

std::vector<ContactPoint> BoxContacts(const Box& box_a, const PlacedRotation& X_WA, const Box& box_b,
                                      const PlacedRotation& X_WB, double margin_m) {
  const PlacedBox a(box_a, X_WA), b(box_b, X_WB);
  const Vector3 between = a.p_W - b.p_W;
  const auto gap = [&](const Vector3& n_W) {
    return std::abs(n_W.dot(between)) - a.Reach(n_W) - b.Reach(n_W);
  };
  struct Way {
    double gap_m = -std::numeric_limits<double>::infinity();
    int of_a = -1, of_b = -1;  // the axes of the face, or of both edges
    Vector3 n_W;
  };
  Way face, edges;
  for (int i = 0; i < 6; ++i) {
    const Vector3 n_W = i < 3 ? a.axes_W.col(i) : b.axes_W.col(i - 3);
    const double gap_m = gap(n_W);
    if (gap_m > margin_m) return {};
    // Prefer the faces of A unless those of B are better.
    constexpr double kBetter_m = 1e-6;
    if (gap_m > face.gap_m + kBetter_m) face = {gap_m, i < 3 ? i : -1, i < 3 ? -1 : i - 3, n_W};
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Vector3 across = a.axes_W.col(i).cross(b.axes_W.col(k));
      const double length = across.norm();
      constexpr double kParallel = 1e-3;
      if (length < kParallel) continue;
      const Vector3 n_W = across / length;
      const double gap_m = gap(n_W);
      if (gap_m > margin_m) return {};
      if (gap_m > edges.gap_m) edges = {gap_m, i, k, n_W};
    }
  }
  const auto from_b = [&](const Vector3& n_W) { return n_W.dot(between) < 0 ? Vector3(-n_W) : n_W; };
  if (edges.gap_m <= face.gap_m + kFaceFirst_m) {
    const Vector3 n_W = from_b(face.n_W);
    const std::vector<ContactPoint> points = face.of_a >= 0 ? AcrossFace(a, face.of_a, -n_W, b, -1, margin_m)
                                                            : AcrossFace(b, face.of_b, n_W, a, 1, margin_m);
    if (!points.empty() || edges.of_a < 0) return points;
  }
  return {AcrossEdges(a, edges.of_a, b, edges.of_b, from_b(edges.n_W), -edges.gap_m)};
}

}  // namespace coopdyn
