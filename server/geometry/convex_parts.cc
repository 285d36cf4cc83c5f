// SPDX-License-Identifier: MIT
#include "server/geometry/convex_parts.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "server/geometry/cell_cuts.h"
#include "server/geometry/cell_grid.h"
#include "server/geometry/convex_cut.h"
#include "server/geometry/lattice_hull.h"
#include "server/geometry/surface_clip.h"

namespace coopdyn {

namespace {

/// Joined pieces and their common hull.
struct Cluster {
  std::vector<CellBox> boxes;
  LatticeHull hull;
  std::int64_t cells6 = 0;  // six times the volume of their cells
};

bool Touch(const CellBox& one, const CellBox& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (one.low[axis] > other.high[axis] || other.low[axis] > one.high[axis]) return false;
  }
  return true;
}

bool Touch(const Cluster& one, const Cluster& other) {
  return std::ranges::any_of(one.boxes, [&](const CellBox& a) {
    return std::ranges::any_of(other.boxes, [&](const CellBox& b) { return Touch(a, b); });
  });
}

/// Repeatedly joins the two clusters whose common hull adds the least volume.
class Joiner {
 public:
  Joiner(const CellGrid& grid, std::vector<Cluster> clusters) : grid_(grid), clusters_(std::move(clusters)) {
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      costs_.emplace_back(i);
      for (std::size_t k = 0; k < i; ++k) costs_[i][k] = AroundBoth(clusters_[i], clusters_[k]);
    }
  }

  /// Joins until `most` are left, then while a common hull adds at most `free6` / 6.
  std::vector<Cluster> Join(std::size_t most, std::int64_t free6) && {
    while (clusters_.size() > 1) {
      std::size_t first = 0, second = 1;
      for (std::size_t i = 1; i < clusters_.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
          if (costs_[i][k] < costs_[second][first]) second = i, first = k;
        }
      }
      if (clusters_.size() <= most && costs_[second][first] > free6) break;
      JoinTwo(first, second);
    }
    return std::move(clusters_);
  }

 private:
  /// Six times the volume that the common hull adds; for clusters that do not touch their common box's
  /// volume instead, which is cheaper to compute.
  std::int64_t AroundBoth(const Cluster& one, const Cluster& other) const {
    if (!Touch(one, other)) return 6 * BoxVolume(one, other) - one.cells6 - other.cells6;
    LatticeHull both = one.hull;
    both.Include(other.hull);
    return both.volume6() - one.cells6 - other.cells6;
  }

  std::int64_t BoxVolume(const Cluster& one, const Cluster& other) const {
    CellBox all = one.boxes.front();
    for (const Cluster* cluster : {&one, &other}) {
      for (const CellBox& box : cluster->boxes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          all.low[axis] = std::min(all.low[axis], box.low[axis]);
          all.high[axis] = std::max(all.high[axis], box.high[axis]);
        }
      }
    }
    std::int64_t volume = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      volume *= grid_.plane(axis, all.high[axis]) - grid_.plane(axis, all.low[axis]);
    return volume;
  }

  /// @pre `second` > `first`
  void JoinTwo(std::size_t first, std::size_t second) {
    Cluster& one = clusters_[first];
    Cluster& other = clusters_[second];
    one.hull.Include(other.hull);
    one.cells6 += other.cells6;
    one.boxes.insert(one.boxes.end(), other.boxes.begin(), other.boxes.end());
    const auto at = static_cast<std::ptrdiff_t>(second);
    clusters_.erase(clusters_.begin() + at);
    costs_.erase(costs_.begin() + at);
    for (std::size_t i = second; i < costs_.size(); ++i) costs_[i].erase(costs_[i].begin() + at);
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      if (i == first) continue;
      const auto [low, high] = std::minmax(i, first);
      costs_[high][low] = AroundBoth(clusters_[high], clusters_[low]);
    }
  }

  const CellGrid& grid_;
  std::vector<Cluster> clusters_;
  std::vector<std::vector<std::int64_t>> costs_;  // [i][k], k < i
};

/// Repeatedly cuts the most concave piece.
std::vector<Piece> Cut(const CellGrid& grid, Piece whole, std::int64_t free6) {
  constexpr std::size_t kMostPieces = 64;
  std::vector<Piece> pieces = {std::move(whole)};
  while (pieces.size() < kMostPieces) {
    const auto worst = std::ranges::max_element(pieces, {}, &Piece::around6);
    if (worst->around6() <= free6) break;
    auto [low, high] = CutInTwo(grid, *worst);
    *worst = std::move(low);
    pieces.push_back(std::move(high));
  }
  return pieces;
}

}  // namespace

ConvexCut CutConvex(std::span<const Vector3> vertices, std::span<const MeshData::Triangle> triangles,
                    int most, int cells) {
  if (most < 2 || !IsThick(vertices, triangles)) return {};
  const CellGrid grid(vertices, triangles, cells);
  if (grid.is_tangled()) return {{}, true};
  const std::optional<Piece> whole = WholeOf(grid);
  if (!whole) return {};
  const std::int64_t hull6 = whole->hull.volume6(), around6 = whole->around6();
  if (static_cast<double>(around6) <= kConcave * static_cast<double>(hull6)) return {};
  constexpr std::int64_t kFinePerHull = 800, kFreePerHull = 100;
  std::vector<Cluster> clusters;
  for (Piece& piece : Cut(grid, *whole, hull6 / kFinePerHull))
    clusters.push_back({{piece.box}, std::move(piece.hull), piece.cells6});
  clusters = Joiner(grid, std::move(clusters)).Join(static_cast<std::size_t>(most), hull6 / kFreePerHull);

  std::int64_t left6 = 0;
  for (const Cluster& one : clusters) left6 += one.hull.volume6() - one.cells6;
  constexpr double kWorthIt = 0.7;
  if (clusters.size() < 2 || static_cast<double>(left6) > kWorthIt * static_cast<double>(around6)) return {};
  const SurfaceClip clip(grid, vertices, triangles);
  ConvexCut cut;
  for (const Cluster& one : clusters) {
    std::vector<Vector3> corners = clip.CornersIn(one.boxes);
    if (!corners.empty()) cut.parts.push_back(std::move(corners));
  }
  return cut;
}

std::vector<std::vector<Vector3>> ConvexParts(std::span<const Vector3> vertices,
                                              std::span<const MeshData::Triangle> triangles, int most) {
  return CutConvex(vertices, triangles, most).parts;
}

}  // namespace coopdyn
