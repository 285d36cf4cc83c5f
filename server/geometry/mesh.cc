// SPDX-License-Identifier: MIT
#include "server/geometry/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "server/base/portable_math.h"
#include "server/base/random.h"

namespace coopdyn {

namespace {

/// Volume and moments of the solid that the triangles enclose, summed over the tetrahedra from the origin.
void Weigh(MeshData& mesh) {
  Vector3 squares = Vector3::Zero();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double volume = p.dot(q.cross(r)) / 6;
    mesh.volume_m3 += volume;
    squares += volume / 10 *
               (p.cwiseAbs2() + q.cwiseAbs2() + r.cwiseAbs2() + p.cwiseProduct(q) + q.cwiseProduct(r) +
                r.cwiseProduct(p));
  }
  mesh.inertia_m5 = {squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y()};
}

/// Sorts triangles so that neighbours are adjacent: recursively halves their box along its longest side.
void SortTriangles(MeshData& mesh, std::uint32_t first, std::uint32_t count) {
  constexpr std::uint32_t kFew = 4;
  if (count <= kFew) return;
  Vector3 low = Vector3::Constant(kNoHit), high = -low;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const std::uint32_t v : mesh.triangles[i]) {
      low = low.cwiseMin(mesh.vertices[v]);
      high = high.cwiseMax(mesh.vertices[v]);
    }
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto begin = mesh.triangles.begin() + first;
  const auto key = [&](const MeshData::Triangle& t) {
    return mesh.vertices[t[0]][axis] + mesh.vertices[t[1]][axis] + mesh.vertices[t[2]][axis];
  };
  std::stable_sort(begin, begin + count,
                   [&](const auto& one, const auto& other) { return key(one) < key(other); });
  SortTriangles(mesh, first, count / 2);
  SortTriangles(mesh, first + count / 2, count - count / 2);
}

/// The points that lie furthest in evenly spread directions, each once, in input order.
std::vector<Vector3> Furthest(std::span<const Vector3> points) {
  constexpr int kDirections = 300;
  std::set<std::size_t> chosen;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const Vector3 direction(r * portable::Cos(golden * i), r * portable::Sin(golden * i), z);
    std::size_t best = 0;
    double furthest = points[0].dot(direction);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double far = points[k].dot(direction);
      if (far > furthest) best = k, furthest = far;
    }
    chosen.insert(best);
  }
  std::vector<Vector3> found;
  for (const std::size_t k : chosen) found.push_back(points[k]);
  return found;
}

/// Moves each point by up to `far`, so that no four points are nearly coplanar, which would give the hull
/// folds and holes: Barber, Dobkin, Huhdanpaa, "The Quickhull Algorithm for Convex Hulls", 1996, section 5
/// (joggled input).
void Joggle(std::vector<Vector3>& points, double far) {
  std::mt19937 bits(1);
  constexpr double kHalf = 0x1p31;
  for (Vector3& p : points) {
    for (double& x : p) x += far * (static_cast<double>(bits()) / kHalf - 1);
  }
}

class HullBuilder {
 public:
  explicit HullBuilder(std::span<const Vector3> points) : points_(points.begin(), points.end()) {}

  /// False if the points lie in a plane.
  bool Build() {
    if (!Start()) return false;
    for (std::uint32_t i = 0; i < points_.size(); ++i) Include(i);
    return true;
  }
  const std::vector<MeshData::Triangle>& faces() const { return faces_; }

 private:
  double Height(const MeshData::Triangle& f, const Vector3& p) const {
    const Vector3 n = (points_[f[1]] - points_[f[0]]).cross(points_[f[2]] - points_[f[0]]);
    return n.normalized().dot(p - points_[f[0]]);
  }

  bool Start() {
    if (points_.size() < 4) return false;
    const auto furthest = [this](auto measure) {
      std::uint32_t best = 0;
      for (std::uint32_t i = 1; i < points_.size(); ++i) {
        if (measure(points_[i]) > measure(points_[best])) best = i;
      }
      return best;
    };
    const std::uint32_t a = 0;
    const std::uint32_t b = furthest([&](const Vector3& p) { return (p - points_[a]).norm(); });
    const double size = (points_[b] - points_[a]).norm();
    const Vector3 along = (points_[b] - points_[a]).normalized();
    const std::uint32_t c = furthest([&](const Vector3& p) { return (p - points_[a]).cross(along).norm(); });
    const Vector3 normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]).normalized();
    const std::uint32_t d =
        furthest([&](const Vector3& p) { return std::abs((p - points_[a]).dot(normal)); });
    constexpr double kFlat = 1e-4;
    if (!(std::abs((points_[d] - points_[a]).dot(normal)) > kFlat * size)) return false;
    tolerance_ = 1e-12 * size;
    Joggle(points_, 1e-6 * size);
    faces_ = {{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}};
    if ((points_[d] - points_[a]).dot(normal) > 0) {
      for (auto& face : faces_) std::swap(face[1], face[2]);
    }
    return true;
  }

  void Include(std::uint32_t point) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<MeshData::Triangle> kept;
    for (const auto& face : faces_) {
      if (Height(face, points_[point]) <= tolerance_) {
        kept.push_back(face);
        continue;
      }
      for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(face[i], face[(i + 1) % 3]);
    }
    if (edges.empty()) return;
    // The rim: edges that two removed faces do not share.
    for (const auto& edge : edges) {
      if (std::ranges::find(edges, std::pair(edge.second, edge.first)) == edges.end())
        kept.push_back({edge.first, edge.second, point});
    }
    faces_ = std::move(kept);
  }

  std::vector<Vector3> points_;
  std::vector<MeshData::Triangle> faces_;
  double tolerance_ = 0;
};

}  // namespace

MeshData MakeMesh(std::vector<Vector3> vertices, std::vector<MeshData::Triangle> triangles, Vector3& middle) {
  MeshData mesh;
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  Vector3 low = mesh.vertices.front(), high = low;
  for (const Vector3& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  middle = (low + high) / 2;
  for (Vector3& v : mesh.vertices) v -= middle;
  mesh.half_m = (high - low) / 2;
  BytesHash hash;
  for (const Vector3& v : mesh.vertices) {
    mesh.radius_m = std::max(mesh.radius_m, v.norm());
    hash.Add(v.data(), 3 * sizeof(double));
  }
  Weigh(mesh);
  SortTriangles(mesh, 0, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) hash.Add(triangle.data(), sizeof(triangle));
  mesh.id = hash.value();
  mesh.tree = RayTree(mesh.vertices, mesh.triangles);
  return mesh;
}

std::optional<MeshData> ConvexHull(std::span<const Vector3> points, Vector3& middle) {
  if (points.size() < 4) return std::nullopt;
  const std::vector<Vector3> chosen = Furthest(points);
  HullBuilder hull(chosen);
  if (!hull.Build()) return std::nullopt;
  // Keep only the vertices that a face uses.
  std::vector<std::uint32_t> numbers(chosen.size(), ~0u);
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles = hull.faces();
  for (auto& triangle : triangles) {
    for (std::uint32_t& v : triangle) {
      if (numbers[v] == ~0u) {
        numbers[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(chosen[v]);
      }
      v = numbers[v];
    }
  }
  return MakeMesh(std::move(vertices), std::move(triangles), middle);
}

double RayToMesh(const Ray& ray, const MeshData& mesh) {
  return mesh.tree.Cast(ray, mesh.vertices);
}

}  // namespace coopdyn
