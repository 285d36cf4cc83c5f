// SPDX-License-Identifier: MIT
#include "server/geometry/surface_clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "server/geometry/lattice_hull.h"
#include "server/geometry/polygon_clip.h"

namespace coopdyn {

namespace {

constexpr double kThin_m = 1e-3;

/// Selects a few corners of a hull so that no other corner lies outside their hull by more than
/// `tolerance_m`. Repeatedly adds the corner that is furthest outside.
class FewCorners {
 public:
  FewCorners(const std::vector<Vector3>& corners, double side_m) : corners_(corners) {
    Vector3 low = corners.front();
    for (const Vector3& corner : corners) low = low.cwiseMin(corner);
    per_m_ = static_cast<double>(kLatticeSide) / side_m;
    for (const Vector3& corner : corners) {
      LatticePoint& point = points_.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        point[axis] = std::min<std::int64_t>(std::llround((corner[i] - low[i]) * per_m_), kLatticeSide);
      }
    }
  }

  /// Returns all corners if they are flat on the lattice.
  std::vector<Vector3> Choose(double tolerance_m) {
    // More would slow down each physics step, which visits all corners of two parts that are close.
    constexpr std::size_t kMost = 60;
    const Vector3& a = corners_[0];
    const std::size_t b = Furthest([&](std::size_t i) { return (corners_[i] - a).norm(); });
    const Vector3 along = corners_[b] - a;
    const std::size_t c = Furthest([&](std::size_t i) { return along.cross(corners_[i] - a).norm(); });
    const Vector3 normal = along.cross(corners_[c] - a);
    const std::size_t d = Furthest([&](std::size_t i) { return std::abs(normal.dot(corners_[i] - a)); });
    LatticeHull hull(points_[0], points_[b], points_[c], points_[d]);
    if (hull.volume6() == 0) return corners_;
    std::vector<Vector3> chosen = {a, corners_[b], corners_[c], corners_[d]};
    while (chosen.size() < kMost) {
      const std::size_t next = Furthest([&](std::size_t i) { return hull.Outside(points_[i]); });
      if (hull.Outside(points_[next]) <= tolerance_m * per_m_) break;
      hull.Include(points_[next]);
      chosen.push_back(corners_[next]);
    }
    return chosen;
  }

 private:
  template <typename Measure>
  std::size_t Furthest(Measure measure) const {
    std::size_t best = 0;
    double most = measure(0);
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      const double far = measure(i);
      if (far > most) best = i, most = far;
    }
    return best;
  }

  const std::vector<Vector3>& corners_;
  double per_m_ = 1;
  std::vector<LatticePoint> points_;
};

/// A few corners of the hull of `points`; nullopt if the points are flat.
std::optional<std::vector<Vector3>> CornersOf(const std::vector<Vector3>& points, double side_m) {
  constexpr double kOfMesh = 1.0 / 250, kOfThickness = 1.0 / 20;
  Vector3 middle = Vector3::Zero();
  auto hull = ConvexHull(points, middle);
  if (!hull) return std::nullopt;
  for (Vector3& v : hull->vertices) v += middle;
  const double tolerance_m = std::min(kOfMesh * side_m, kOfThickness * 2 * hull->half_m.minCoeff());
  std::vector<Vector3> few = FewCorners(hull->vertices, side_m).Choose(tolerance_m);
  // The hull of the selected corners must be a solid, too.
  if (!ConvexHull(few, middle)) return std::nullopt;
  return few;
}

}  // namespace

bool IsThick(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles) {
  Vector3 low = vertices[triangles.front()[0]], high = low;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t v : triangle) {
      low = low.cwiseMin(vertices[v]);
      high = high.cwiseMax(vertices[v]);
    }
  }
  constexpr double kLeast = 64.0 / static_cast<double>(kLatticeSide);
  return (high - low).minCoeff() > kLeast * (high - low).maxCoeff();
}

SurfaceClip::SurfaceClip(const CellGrid& grid, std::span<const Vector3> vertices,
                         std::span<const MeshData::Triangle> triangles)
    : grid_(grid), vertices_(vertices), triangles_(triangles) {
  for (const auto& [a, b, c] : triangles)
    behind_.push_back(grid.Behind(vertices[a], vertices[b], vertices[c]));
}

std::vector<Vector3> SurfaceClip::CornersIn(std::span<const CellBox> boxes) const {
  std::vector<Vector3> points;
  Vector3 behind = Vector3::Zero();
  for (const CellBox& box : boxes) AddPoints(box, points, behind);
  const double side_m = grid_.unit_m() * static_cast<double>(kLatticeSide);
  if (auto corners = CornersOf(points, side_m)) return *corners;
  if (!(behind.norm() > 0)) return {};
  behind *= kThin_m / behind.norm();
  for (std::size_t i = 0, count = points.size(); i < count; ++i) points.push_back(points[i] + behind);
  return CornersOf(points, side_m).value_or(std::vector<Vector3>());
}

// Moves triangles behind their surface and shrinks the box slightly, so that a surface in the plane between
// two boxes belongs to the box behind it, and a surface that only reaches that plane to its own box. Then
// undoes both.
void SurfaceClip::AddPoints(const CellBox& box, std::vector<Vector3>& points, Vector3& behind) const {
  const double shrunk_m = grid_.unit_m(), near_m = 2 * CellGrid::kBehind * grid_.unit_m();
  Vector3 low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[static_cast<Eigen::Index>(axis)] = grid_.plane_m(axis, box.low[axis]);
    high[static_cast<Eigen::Index>(axis)] = grid_.plane_m(axis, box.high[axis]);
  }
  Vector3 from = low + Vector3::Constant(shrunk_m), to = high - Vector3::Constant(shrunk_m);
  for (std::size_t axis = 0; axis < 3; ++axis) {  // at the grid's border no other box claims the surface
    const auto i = static_cast<Eigen::Index>(axis);
    if (box.low[axis] == 0) from[i] = low[i] - near_m;
    if (box.high[axis] == grid_.count(axis)) to[i] = high[i] + near_m;
  }
  std::vector<Vector3> polygon, scratch;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto& [a, b, c] = triangles_[t];
    const Vector3 &p = vertices_[a], &q = vertices_[b], &r = vertices_[c];
    if ((p.cwiseMin(q).cwiseMin(r).array() > high.array()).any() ||
        (p.cwiseMax(q).cwiseMax(r).array() < low.array()).any())
      continue;
    if (behind_[t].isZero(0)) continue;
    polygon.assign({p + behind_[t], q + behind_[t], r + behind_[t]});
    for (Eigen::Index axis = 0; axis < 3 && !polygon.empty(); ++axis) {
      ClipPolygon(axis, -1, from[axis], polygon, scratch);
      ClipPolygon(axis, 1, to[axis], polygon, scratch);
    }
    for (const Vector3& corner : polygon) {
      Vector3 point = corner - behind_[t];
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        if (point[axis] < low[axis] + near_m) point[axis] = low[axis];
        if (point[axis] > high[axis] - near_m) point[axis] = high[axis];
      }
      points.push_back(point);
    }
    if (polygon.size() >= 3) behind += behind_[t];
  }
  for (int which = 0; which < 8; ++which) {
    CellGrid::Place corner{};
    Vector3 point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      const bool is_high = (which >> axis & 1) != 0;
      corner[axis] = is_high ? box.high[axis] : box.low[axis];
      point[i] = is_high ? high[i] : low[i];
    }
    if (grid_.IsCornerWithin(corner)) points.push_back(point);
  }
}

}  // namespace coopdyn
