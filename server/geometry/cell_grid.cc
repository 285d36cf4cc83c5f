// SPDX-License-Identifier: MIT
#include "server/geometry/cell_grid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include "server/geometry/lattice_hull.h"
#include "server/geometry/polygon_clip.h"

namespace coopdyn {

namespace {

constexpr double kMostOnSide = 128;
constexpr std::size_t kMostLooks = 10'000'000;  // a few tenths of a second

/// True if the triangle touches the box centred at the origin: T. Akenine-Möller (2001), "Fast 3D
/// triangle-box overlap testing". @pre the triangle's bounding box touches it.
bool Touches(const std::array<Vector3, 3>& corners, const Vector3& half) {
  const std::array<Vector3, 3> edges = {corners[1] - corners[0], corners[2] - corners[1],
                                        corners[0] - corners[2]};
  const auto is_apart = [&](const Vector3& axis) {
    const double p = axis.dot(corners[0]), q = axis.dot(corners[1]), r = axis.dot(corners[2]);
    const double reach = half.dot(axis.cwiseAbs());
    return std::min({p, q, r}) > reach || std::max({p, q, r}) < -reach;
  };
  if (is_apart(edges[0].cross(edges[1]))) return false;
  for (const Vector3& edge : edges) {
    if (is_apart({0, -edge.z(), edge.y()}) || is_apart({edge.z(), 0, -edge.x()}) ||
        is_apart({-edge.y(), edge.x(), 0}))
      return false;
  }
  return true;
}

}  // namespace

Vector3 CellGrid::Behind(const Vector3& a, const Vector3& b, const Vector3& c) const {
  const Vector3 n = (b - a).cross(c - a);
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  if (!(n.norm() > unit_m_ * longest)) return Vector3::Zero();
  return n * (-kBehind * unit_m_ / n.norm());
}

bool CellGrid::is_tangled() const {
  return looks_ > kMostLooks;
}

CellGrid::CellGrid(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                   int most_cells) {
  PlacePlanes(vertices, triangles, most_cells);
  cells_.resize(static_cast<std::size_t>(count(0)) * static_cast<std::size_t>(count(1)) *
                static_cast<std::size_t>(count(2)));
  for (const auto& [a, b, c] : triangles) {
    const Vector3 behind = Behind(vertices[a], vertices[b], vertices[c]);
    if (!behind.isZero(0)) MarkSurface({vertices[a] + behind, vertices[b] + behind, vertices[c] + behind});
    if (is_tangled()) return;
  }
  MarkOutside();
}

void CellGrid::PlacePlanes(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                           int most_cells) {
  Vector3 low = vertices[triangles.front()[0]], high = low;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t v : triangle) {
      low = low.cwiseMin(vertices[v]);
      high = high.cwiseMax(vertices[v]);
    }
  }
  const Vector3 size = high - low;
  const double side_m = size.maxCoeff();
  unit_m_ = side_m / static_cast<double>(kLatticeSide);
  // The smallest size that the number of cells allows; thin sides have one cell.
  double cell_m = side_m / kMostOnSide;
  const auto cells_for = [&](double step_m) {
    return std::ceil(size.x() / step_m) * std::ceil(size.y() / step_m) * std::ceil(size.z() / step_m);
  };
  while (cells_for(cell_m) > most_cells) cell_m *= 1.1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    // The area of the faces across the axis, by their lattice coordinate.
    std::map<std::int64_t, std::pair<double, double>> areas;  // area, exact coordinate
    for (const auto& [a, b, c] : triangles) {
      const Vector3 &p = vertices[a], &q = vertices[b], &r = vertices[c];
      if (std::max({p[i], q[i], r[i]}) - std::min({p[i], q[i], r[i]}) > unit_m_) continue;
      auto& [area, where] =
          areas.try_emplace(std::llround((p[i] - low[i]) / unit_m_), 0.0, p[i]).first->second;
      area += (q - p).cross(r - p).norm() / 2;
    }
    std::vector<std::pair<double, double>> faces;
    const double box_area = size[(i + 1) % 3] * size[(i + 2) % 3];
    constexpr double kLarge = 1.0 / 200;
    for (const auto& [at, face] : areas) {
      if (face.first > kLarge * box_area) faces.push_back(face);
    }
    std::ranges::stable_sort(faces, {}, [](const auto& face) { return -face.first; });
    constexpr std::size_t kMostFaces = 24;
    if (faces.size() > kMostFaces) faces.resize(kMostFaces);
    std::vector<double> fixed = {low[i], high[i]};
    const double apart_m = std::max(cell_m / 8, 16 * unit_m_);
    for (const auto& [area, where] : faces) {
      const auto is_near = [&, at = where](double other) { return std::abs(at - other) < apart_m; };
      if (std::ranges::none_of(fixed, is_near)) fixed.push_back(where);
    }
    std::ranges::sort(fixed);
    for (std::size_t k = 0; k + 1 < fixed.size(); ++k) {
      const double gap = fixed[k + 1] - fixed[k];
      const int parts = std::max(1, static_cast<int>(std::ceil(gap / cell_m - 1e-6)));
      for (int part = 0; part < parts; ++part) planes_[axis].push_back(fixed[k] + gap * part / parts);
    }
    planes_[axis].push_back(high[i]);
    for (const double plane : planes_[axis])
      lattice_[axis].push_back(std::llround((plane - low[i]) / unit_m_));
  }
}

std::pair<int, int> CellGrid::CellsIn(std::size_t axis, double low, double high) const {
  const std::vector<double>& planes = planes_[axis];
  const auto place = [&](auto it) { return static_cast<int>(it - planes.begin()); };
  const int first = std::clamp(place(std::ranges::upper_bound(planes, low)) - 1, 0, count(axis) - 1);
  return {first, std::clamp(place(std::ranges::lower_bound(planes, high)), first + 1, count(axis))};
}

std::pair<int, int> CellGrid::CellsOf(std::size_t axis, std::span<const Vector3> polygon, double in) const {
  const auto i = static_cast<Eigen::Index>(axis);
  const auto [low, high] =
      std::ranges::minmax(polygon | std::views::transform([i](const Vector3& p) { return p[i]; }));
  // A flat polygon lies in one cell.
  in = std::min(in, (high - low) / 2);
  return CellsIn(axis, low + in, high - in);
}

// Cuts the triangle into strips along the planes, so that it visits few cells that the triangle misses.
void CellGrid::MarkSurface(const std::array<Vector3, 3>& corners) {
  constexpr double kShrunk = 1;  // units by which cells shrink on each side for the touch test
  std::array<std::pair<int, int>, 3> range;
  for (std::size_t axis = 0; axis < 3; ++axis) range[axis] = CellsOf(axis, corners, kShrunk * unit_m_);
  const auto is_one = [](const auto& one) { return one.second == one.first + 1; };
  const bool is_small = std::ranges::count_if(range, is_one) >= 2;  // then it touches all cells in range
  const auto narrow = [&](const std::pair<int, int>& all, std::size_t axis,
                          const std::vector<Vector3>& polygon) {
    const auto [first, end] = CellsOf(axis, polygon, 0);
    return std::pair(std::max(first, all.first), std::min(end, all.second));
  };
  const auto cut = [&](std::size_t axis, int cell, std::vector<Vector3>& polygon) {
    const auto i = static_cast<Eigen::Index>(axis);
    ClipPolygon(i, -1, plane_m(axis, cell), polygon, scratch_);
    ClipPolygon(i, 1, plane_m(axis, cell + 1), polygon, scratch_);
  };
  for (int i = range[0].first; i < range[0].second; ++i) {
    auto of_slab = range[1];
    slab_.assign(corners.begin(), corners.end());
    if (!is_small) {
      cut(0, i, slab_);
      if (slab_.empty()) continue;
      of_slab = narrow(range[1], 1, slab_);
    }
    for (int j = of_slab.first; j < of_slab.second; ++j) {
      auto of_strip = range[2];
      if (!is_small) {
        strip_ = slab_;
        cut(1, j, strip_);
        if (strip_.empty()) continue;
        of_strip = narrow(range[2], 2, strip_);
      }
      looks_ += 1 + static_cast<std::size_t>(std::max(0, of_strip.second - of_strip.first));
      for (int k = of_strip.first; k < of_strip.second; ++k) {
        Cell& cell = cells_[Index({i, j, k})];
        if (cell == Cell::kSurface) continue;
        const Vector3 from(plane_m(0, i), plane_m(1, j), plane_m(2, k)),
            to(plane_m(0, i + 1), plane_m(1, j + 1), plane_m(2, k + 1));
        const Vector3 middle = (from + to) / 2, half = (to - from) / 2;
        if (is_small || Touches({corners[0] - middle, corners[1] - middle, corners[2] - middle},
                                half - Vector3::Constant(kShrunk * unit_m_)))
          cell = Cell::kSurface;
      }
    }
  }
}

void CellGrid::MarkOutside() {
  std::vector<Place> open;
  const auto reach = [&](const Place& place) {
    Cell& cell = cells_[Index(place)];
    if (cell != Cell::kUnknown) return;
    cell = Cell::kOutside;
    open.push_back(place);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < count(u); ++i) {
      for (int k = 0; k < count(v); ++k) {
        for (const int end : {0, count(axis) - 1}) {
          Place place{};
          place[axis] = end;
          place[u] = i;
          place[v] = k;
          reach(place);
        }
      }
    }
  }
  while (!open.empty()) {
    const Place from = open.back();
    open.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        Place to = from;
        to[axis] += step;
        if (to[axis] >= 0 && to[axis] < count(axis)) reach(to);
      }
    }
  }
}

bool CellGrid::IsCornerWithin(const Place& corner) const {
  for (int which = 0; which < 8; ++which) {
    const Place cell = {corner[0] - (which & 1), corner[1] - (which >> 1 & 1), corner[2] - (which >> 2 & 1)};
    bool is_there = true;
    for (std::size_t axis = 0; axis < 3; ++axis)
      is_there = is_there && cell[axis] >= 0 && cell[axis] < count(axis);
    if (is_there && cells_[Index(cell)] == Cell::kUnknown) return true;
  }
  return false;
}

}  // namespace coopdyn
