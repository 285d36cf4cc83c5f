// SPDX-License-Identifier: MIT
#include "server/files/reduce_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace coopdyn {

namespace {

using Triangle = MeshData::Triangle;

class Grid {
 public:
  explicit Grid(const MeshParts& parts) : parts_(parts), low_(parts.vertices.front()), high_(low_) {
    for (const Vector3& v : parts.vertices) {
      low_ = low_.cwiseMin(v);
      high_ = high_.cwiseMax(v);
    }
  }

  double side_m() const { return (high_ - low_).maxCoeff(); }

  /// The triangles that remain if the longest side has `cells` cells, as indices into the vertices of
  /// `parts`.
  std::vector<Triangle> TrianglesFor(std::uint32_t cells) const {
    const std::vector<std::uint32_t> stands_for = StandsFor(cells);
    std::vector<Triangle> kept;
    for (const Triangle& triangle : parts_.triangles) {
      Triangle t{stands_for[triangle[0]], stands_for[triangle[1]], stands_for[triangle[2]]};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      std::ranges::rotate(t, std::ranges::min_element(t));
      kept.push_back(t);
    }
    std::ranges::sort(kept);
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
  }

 private:
  /// For each vertex, the vertex of its cell and material that replaces it.
  std::vector<std::uint32_t> StandsFor(std::uint32_t cells) const {
    struct Member {
      std::uint64_t cell = 0;
      std::uint32_t material = 0;
      double nearness = 0;  // smallest for the vertex furthest from the centre
      std::uint32_t vertex = 0;
    };
    const Vector3 middle = (low_ + high_) / 2;
    const double per_m = side_m() > 0 ? cells / side_m() : 0;
    std::vector<Member> members;
    members.reserve(parts_.vertices.size());
    for (std::uint32_t i = 0; i < parts_.vertices.size(); ++i) {
      const Vector3& v = parts_.vertices[i];
      std::uint64_t cell = 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const auto place = static_cast<std::uint64_t>(std::floor((v[axis] - low_[axis]) * per_m));
        cell = cell << 12u | std::min<std::uint64_t>(place, cells - 1);
      }
      const std::uint32_t material = parts_.skin == nullptr ? 0 : parts_.skin->corners[i].material;
      members.push_back({cell, material, -(v - middle).squaredNorm(), i});
    }
    std::ranges::sort(members, {}, [](const Member& one) {
      return std::tuple(one.cell, one.material, one.nearness, one.vertex);
    });
    std::vector<std::uint32_t> stands_for(members.size());
    const Member* first = nullptr;
    for (const Member& one : members) {
      if (first == nullptr || first->cell != one.cell || first->material != one.material) first = &one;
      stands_for[one.vertex] = first->vertex;
    }
    return stands_for;
  }

  const MeshParts& parts_;
  Vector3 low_, high_;
};

/// `triangles` with the vertices of `parts` that they use.
MeshParts Used(const MeshParts& parts, std::vector<Triangle> triangles) {
  constexpr std::uint32_t kNone = ~0u;
  MeshParts used;
  used.color = parts.color;
  auto skin = parts.skin == nullptr ? nullptr : std::make_shared<MeshSkin>();
  if (skin != nullptr) skin->materials = parts.skin->materials;
  std::vector<std::uint32_t> numbers(parts.vertices.size(), kNone);
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& v : triangle) {
      if (numbers[v] == kNone) {
        numbers[v] = static_cast<std::uint32_t>(used.vertices.size());
        used.vertices.push_back(parts.vertices[v]);
        if (skin != nullptr) skin->corners.push_back(parts.skin->corners[v]);
      }
      v = numbers[v];
    }
  }
  used.triangles = std::move(triangles);
  used.skin = std::move(skin);
  return used;
}

}  // namespace

ReducedMesh Reduce(MeshParts parts, std::size_t most) {
  if (parts.triangles.size() <= most) return {std::move(parts), 0};
  const Grid grid(parts);
  constexpr std::uint32_t kMostCells = 2048, kFewestCells = 4;
  std::vector<Triangle> kept;
  for (std::uint32_t cells = kMostCells; cells >= kFewestCells;) {
    kept = grid.TrianglesFor(cells);
    if (kept.size() <= most) {
      // The triangles are grains smaller than a cell: see below.
      if (kept.size() < most / 100) break;
      const double cell_m = grid.side_m() / cells;
      return {Used(parts, std::move(kept)), cell_m * std::sqrt(3.0)};
    }
    // A surface's number of triangles grows with the square of `cells`.
    const double factor = std::sqrt(static_cast<double>(most) / static_cast<double>(kept.size()));
    cells = static_cast<std::uint32_t>(cells * std::clamp(factor, 0.3, 0.95));
  }
  // Not a surface: keep an even selection of the triangles.
  kept.clear();
  for (std::size_t i = 0; i < most; ++i) kept.push_back(parts.triangles[i * parts.triangles.size() / most]);
  return {Used(parts, std::move(kept)), grid.side_m()};
}

std::string ReductionText(std::size_t count, const ReducedMesh& reduced) {
  const auto moved_mm = static_cast<long>(std::ceil(1e3 * reduced.moved_m));
  return "it has " + std::to_string(count) + " triangles: " + std::to_string(reduced.parts.triangles.size()) +
         " stand for them, and no corner moves by more than " + std::to_string(moved_mm) + " mm";
}

}  // namespace coopdyn
