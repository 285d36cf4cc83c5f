// SPDX-License-Identifier: MIT
#include "server/geometry/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace coopdyn {

namespace {

/// FNV-1a over the bits.
class Hash {
 public:
  void Add(const void* data, std::size_t bytes) {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) value_ = (value_ ^ byte[i]) * 1099511628211u;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

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

/// Neighbours next to each other: each half of the longer side of its box before the other, and so on.
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

/// The points that lie furthest in evenly spread directions, each once, in their order.
std::vector<Vector3> Furthest(std::span<const Vector3> points) {
  constexpr int kDirections = 300;
  std::set<std::size_t> chosen;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const Vector3 direction(r * std::cos(golden * i), r * std::sin(golden * i), z);
    std::size_t best = 0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      if (points[k].dot(direction) > points[best].dot(direction)) best = k;
    }
    chosen.insert(best);
  }
  std::vector<Vector3> found;
  for (const std::size_t k : chosen) found.push_back(points[k]);
  return found;
}

class HullBuilder {
 public:
  explicit HullBuilder(std::span<const Vector3> points) : points_(points) {}

  /// False if the points lie in a plane.
  bool Build() {
    if (!Start()) return false;
    std::vector<std::uint32_t> left(points_.size());
    std::iota(left.begin(), left.end(), 0u);
    std::erase_if(left, [this](std::uint32_t point) {
      return std::ranges::any_of(faces_,
                                 [point](const auto& f) { return std::ranges::find(f, point) != f.end(); });
    });
    // Points that cannot be included now are tried again when others have been. In the end they lie as close
    // to the hull as rounding tells.
    for (std::size_t before = 0; before != left.size();) {
      before = left.size();
      std::erase_if(left, [this](std::uint32_t point) { return Include(point); });
    }
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
    tolerance_ = 1e-9 * size;
    faces_ = {{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}};
    if ((points_[d] - points_[a]).dot(normal) > 0) {
      for (auto& face : faces_) std::swap(face[1], face[2]);
    }
    return true;
  }

  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  static std::array<Edge, 3> EdgesOf(const MeshData::Triangle& f) {
    return {Edge{f[0], f[1]}, Edge{f[1], f[2]}, Edge{f[2], f[0]}};
  }

  /// The faces that the point lies above and that hang together with the one that it lies highest above.
  std::set<std::size_t> Below(std::uint32_t point) const {
    std::map<Edge, std::size_t> face_at;  // of faces that the point lies above
    std::size_t highest = faces_.size();
    double most = tolerance_;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const double height = Height(faces_[i], points_[point]);
      if (!(height > tolerance_)) continue;
      for (const Edge& edge : EdgesOf(faces_[i])) face_at.emplace(edge, i);
      if (height > most) {
        most = height;
        highest = i;
      }
    }
    std::set<std::size_t> found;
    for (std::vector<std::size_t> next = {highest}; !next.empty();) {
      const std::size_t face = next.back();
      next.pop_back();
      if (face == faces_.size() || !found.insert(face).second) continue;
      for (const auto& [from, to] : EdgesOf(faces_[face])) {
        if (const auto beside = face_at.find({to, from}); beside != face_at.end())
          next.push_back(beside->second);
      }
    }
    return found;
  }

  /// False if the faces below the point are no disc, as only rounding makes them: a hull with one more point
  /// would have holes, and ever more faces.
  bool Include(std::uint32_t point) {
    const std::set<std::size_t> below = Below(point);
    if (below.empty()) return true;
    std::vector<Edge> edges, rim;
    std::set<std::uint32_t> corners, starts;
    for (const std::size_t face : below) {
      for (const Edge& edge : EdgesOf(faces_[face])) {
        edges.push_back(edge);
        corners.insert(edge.first);
      }
    }
    // The rim: edges that are not shared by two faces that go.
    for (const Edge& edge : edges) {
      if (std::ranges::find(edges, Edge(edge.second, edge.first)) != edges.end()) continue;
      rim.push_back(edge);
      starts.insert(edge.first);
    }
    // Euler's formula: corners - edges + faces = 1; each edge but those of the rim was met twice.
    const std::size_t edge_count = (edges.size() + rim.size()) / 2;
    if (corners.size() + below.size() != edge_count + 1 || starts.size() != rim.size()) return false;
    std::vector<MeshData::Triangle> kept;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (!below.contains(i)) kept.push_back(faces_[i]);
    }
    for (const auto& [from, to] : rim) kept.push_back({from, to, point});
    faces_ = std::move(kept);
    return true;
  }

  std::span<const Vector3> points_;
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
  Hash hash;
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
  // Only the vertices that a face uses.
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
