// SPDX-License-Identifier: MIT
#include "server/geometry/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

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

class TreeBuilder {
 public:
  explicit TreeBuilder(MeshData& mesh) : mesh_(mesh) {}

  void Build(std::uint32_t first, std::uint32_t count) {
    constexpr std::uint32_t kLeaf = 4;
    const std::size_t at = mesh_.tree.size();
    mesh_.tree.emplace_back();
    Vector3 low = Vector3::Constant(kNoHit), high = -low;
    for (std::uint32_t i = first; i < first + count; ++i) {
      for (const std::uint32_t v : mesh_.triangles[i]) {
        low = low.cwiseMin(mesh_.vertices[v]);
        high = high.cwiseMax(mesh_.vertices[v]);
      }
    }
    const Vector3 pad = Vector3::Constant(1e-9);
    mesh_.tree[at].low = low - pad;
    mesh_.tree[at].high = high + pad;
    if (count <= kLeaf) {
      mesh_.tree[at].first = first;
      mesh_.tree[at].count = count;
      return;
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto begin = mesh_.triangles.begin() + first;
    const auto key = [&](const MeshData::Triangle& t) {
      return mesh_.vertices[t[0]][axis] + mesh_.vertices[t[1]][axis] + mesh_.vertices[t[2]][axis];
    };
    std::stable_sort(begin, begin + count,
                     [&](const auto& one, const auto& other) { return key(one) < key(other); });
    Build(first, count / 2);
    mesh_.tree[at].right = static_cast<std::uint32_t>(mesh_.tree.size());
    Build(first + count / 2, count - count / 2);
  }

 private:
  MeshData& mesh_;
};

bool MeetsBox(const Ray& ray, const Vector3& inverse, const MeshData::Node& node, double nearest_m) {
  double from = 0, to = nearest_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (node.low[axis] - ray.origin[axis]) * inverse[axis];
    const double b = (node.high[axis] - ray.origin[axis]) * inverse[axis];
    // A ray along a face gives nan, which min and max ignore in this order.
    from = std::max(from, std::min(b, a));
    to = std::min(to, std::max(b, a));
  }
  return from <= to;
}

double RayToTriangle(const Ray& ray, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 u = b - a, v = c - a;
  const Vector3 h = ray.direction.cross(v);
  const double det = u.dot(h);
  if (det == 0) return kNoHit;
  const Vector3 s = ray.origin - a;
  const double x = s.dot(h) / det;
  const Vector3 q = s.cross(u);
  const double y = ray.direction.dot(q) / det;
  constexpr double kEdge = -1e-12;
  if (x < kEdge || y < kEdge || x + y > 1 - kEdge) return kNoHit;
  const double t = v.dot(q) / det;
  return t >= 0 ? t : kNoHit;
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
    tolerance_ = 1e-9 * size;
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
    // The rim: edges that are not shared by two faces that go.
    for (const auto& edge : edges) {
      if (std::ranges::find(edges, std::pair(edge.second, edge.first)) == edges.end())
        kept.push_back({edge.first, edge.second, point});
    }
    faces_ = std::move(kept);
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
  TreeBuilder(mesh).Build(0, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) hash.Add(triangle.data(), sizeof(triangle));
  mesh.id = hash.value();
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
  const Vector3 inverse = ray.direction.cwiseInverse();
  double nearest = kNoHit;
  constexpr std::size_t kDepth = 64;  // the tree halves: 2^32 triangles need 32
  std::array<std::uint32_t, kDepth> stack{};
  std::size_t count = 1;
  while (count > 0) {
    const std::uint32_t at = stack[--count];
    const MeshData::Node& node = mesh.tree[at];
    if (!MeetsBox(ray, inverse, node, nearest)) continue;
    if (node.count == 0) {
      stack[count++] = node.right;
      stack[count++] = at + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      nearest = std::min(nearest, RayToTriangle(ray, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
    }
  }
  return nearest;
}

}  // namespace coopdyn
