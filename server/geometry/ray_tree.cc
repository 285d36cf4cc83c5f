// SPDX-License-Identifier: MIT
#include "server/geometry/ray_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace coopdyn {

namespace {

// Bound of the error of float arithmetic, as a fraction of the mesh's size.
constexpr double kFloatError = 2e-6;
// A component of a direction that counts as zero; its inverse is still a finite float.
constexpr double kNoDirection = 1e-18;

using Float4 = Eigen::Array<float, 4, 1>;

Eigen::Map<const Float4, Eigen::Aligned16> Four(const std::array<float, 4>& values) {
  return Eigen::Map<const Float4, Eigen::Aligned16>(values.data());
}

struct Bounds {
  Vector3 low = Vector3::Constant(kNoHit), high = Vector3::Constant(-kNoHit);

  void Include(const Vector3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void Include(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  double HalfArea() const {
    const Vector3 size = high - low;
    return size.x() < 0 ? 0 : size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
  }
};

}  // namespace

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

/// Builds a binary tree by the surface area heuristic, which minimizes a ray's expected work, then joins two
/// levels into one.
class RayTreeBuilder {
 public:
  RayTreeBuilder(RayTree& tree, std::span<const Vector3> vertices,
                 std::span<const RayTree::Triangle> triangles)
      : tree_(tree) {
    items_.reserve(triangles.size());
    Bounds all;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      Item item;
      item.triangle = i;
      for (const std::uint32_t v : triangles[i]) item.bounds.Include(vertices[v]);
      item.middle = (item.bounds.low + item.bounds.high) / 2;
      all.Include(item.bounds);
      items_.push_back(item);
    }
    if (items_.empty()) return;
    pad_m_ = kFloatError * (all.high - all.low).norm() + 1e-9;
    tree_.pad_m_ = static_cast<float>(pad_m_);
    tree_.low_ = all.low - Vector3::Constant(pad_m_);
    tree_.high_ = all.high + Vector3::Constant(pad_m_);
    const std::uint32_t root = Halve(0, static_cast<std::uint32_t>(items_.size()), 0);
    Join(root);
    tree_.triangles_.reserve(items_.size());
    for (const Item& item : items_) tree_.triangles_.push_back(triangles[item.triangle]);
  }

 private:
  struct Item {
    Bounds bounds;
    Vector3 middle;
    std::uint32_t triangle = 0;
  };
  struct Half {
    Bounds bounds;
    std::uint32_t first = 0, count = 0;  // count 0: not a leaf
    std::uint32_t left = 0, right = 0;
  };

  static constexpr std::uint32_t kLeaf = 4;
  static constexpr std::size_t kBins = 16;
  static constexpr int kMostUneven = 40;  // levels; deeper levels split evenly

  std::uint32_t Halve(std::uint32_t first, std::uint32_t count, int depth) {
    const auto at = static_cast<std::uint32_t>(halves_.size());
    halves_.emplace_back();
    Bounds bounds, middles;
    for (const Item& item : std::span(items_).subspan(first, count)) {
      bounds.Include(item.bounds);
      middles.Include(item.middle);
    }
    halves_[at].bounds = bounds;
    if (count <= kLeaf) {
      halves_[at].first = first;
      halves_[at].count = count;
      return at;
    }
    const std::uint32_t left = depth < kMostUneven ? Split(first, count, middles) : count / 2;
    const std::uint32_t one = Halve(first, left, depth + 1);
    const std::uint32_t other = Halve(first + left, count - left, depth + 1);
    halves_[at].left = one;
    halves_[at].right = other;
    return at;
  }

  /// Sorts the items into two parts and returns the size of the first.
  std::uint32_t Split(std::uint32_t first, std::uint32_t count, const Bounds& middles) {
    const std::span<Item> items = std::span(items_).subspan(first, count);
    struct Best {
      double cost = kNoHit;
      Eigen::Index axis = 0;
      std::size_t bin = 0;
    } best;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (!(middles.high[axis] > middles.low[axis])) continue;
      std::array<Bounds, kBins> bounds;
      std::array<std::uint32_t, kBins> counts{};
      for (const Item& item : items) {
        const std::size_t bin = Bin(item, axis, middles);
        bounds[bin].Include(item.bounds);
        ++counts[bin];
      }
      std::array<double, kBins> above{};  // cost of this bin and all above it
      Bounds part;
      std::uint32_t in_part = 0;
      for (std::size_t bin = kBins; bin-- > 0;) {
        part.Include(bounds[bin]);
        in_part += counts[bin];
        above[bin] = part.HalfArea() * in_part;
      }
      part = {};
      in_part = 0;
      for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
        part.Include(bounds[bin]);
        in_part += counts[bin];
        if (in_part == 0 || in_part == count) continue;
        const double cost = part.HalfArea() * in_part + above[bin + 1];
        if (cost < best.cost) best = {cost, axis, bin};
      }
    }
    if (best.cost == kNoHit) return count / 2;  // all middles coincide
    const auto middle = std::stable_partition(items.begin(), items.end(), [&](const Item& item) {
      return Bin(item, best.axis, middles) <= best.bin;
    });
    return static_cast<std::uint32_t>(middle - items.begin());
  }
  static std::size_t Bin(const Item& item, Eigen::Index axis, const Bounds& middles) {
    const double part = (item.middle[axis] - middles.low[axis]) / (middles.high[axis] - middles.low[axis]);
    return std::min(kBins - 1, static_cast<std::size_t>(part * kBins));
  }

  /// Makes a node of the largest boxes below the binary node `root`.
  std::uint32_t Join(std::uint32_t root) {
    std::array<std::uint32_t, 4> children{root};
    std::size_t count = 1;
    while (count < children.size()) {
      std::size_t widest = count;
      double area = -1;
      for (std::size_t i = 0; i < count; ++i) {
        const Half& half = halves_[children[i]];
        if (half.count > 0 || half.bounds.HalfArea() <= area) continue;
        area = half.bounds.HalfArea();
        widest = i;
      }
      if (widest == count) break;
      const Half& half = halves_[children[widest]];
      children[widest] = half.left;
      children[count++] = half.right;
    }
    const auto at = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    RayTree::Node node{};
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (i >= count) {
        for (std::size_t side = 0; side < 6; ++side) {
          node.bounds[side][i] =
              side < 3 ? std::numeric_limits<float>::max() : std::numeric_limits<float>::lowest();
        }
        continue;
      }
      const Half& half = halves_[children[i]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        node.bounds[axis][i] = static_cast<float>(half.bounds.low[k] - pad_m_);
        node.bounds[axis + 3][i] = static_cast<float>(half.bounds.high[k] + pad_m_);
      }
      node.count[i] = half.count;
      node.child[i] = half.count > 0 ? half.first : Join(children[i]);
    }
    tree_.nodes_[at] = node;
    return at;
  }

  RayTree& tree_;
  std::vector<Item> items_;
  std::vector<Half> halves_;
  double pad_m_ = 0;
};

RayTree::RayTree(std::span<const Vector3> vertices, std::span<const Triangle> triangles) {
  RayTreeBuilder(*this, vertices, triangles);
}

double RayTree::Cast(const Ray& ray, std::span<const Vector3> vertices) const {
  if (nodes_.empty()) return kNoHit;
  // Where the ray enters the overall box: from there on, floats are precise enough.
  double enter = 0, leave = kNoHit;
  std::array<float, 3> inverse{};
  std::array<std::size_t, 3> near_side{}, far_side{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    double d = ray.direction[k];
    if (std::abs(d) < kNoDirection) d = d < 0 ? -kNoDirection : kNoDirection;
    const double to_low = (low_[k] - ray.origin[k]) / d, to_high = (high_[k] - ray.origin[k]) / d;
    enter = std::max(enter, std::min(to_low, to_high));
    leave = std::min(leave, std::max(to_low, to_high));
    inverse[axis] = static_cast<float>(1 / d);
    near_side[axis] = d < 0 ? axis + 3 : axis;
    far_side[axis] = d < 0 ? axis : axis + 3;
  }
  if (enter > leave) return kNoHit;
  const Eigen::Vector3f start = (ray.origin + enter * ray.direction).cast<float>();

  struct Waiting {
    float from;
    std::uint32_t child, count;
  };
  std::array<Waiting, kStack> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): written first
  std::size_t waiting = 0;
  double nearest = kNoHit;
  float limit = std::numeric_limits<float>::max();  // skip boxes that are further away
  Waiting now{0, 0, 0};
  for (;;) {
    if (now.count == 0) {
      const Node& node = nodes_[now.child];
      const auto along = [&](std::size_t side, std::size_t axis) {
        return (Four(node.bounds[side]) - start[static_cast<Eigen::Index>(axis)]) * inverse[axis];
      };
      const Float4 from =
          along(near_side[0], 0).max(along(near_side[1], 1)).max(along(near_side[2], 2)).max(0.0F);
      const Float4 to =
          along(far_side[0], 0).min(along(far_side[1], 1)).min(along(far_side[2], 2)).min(limit);
      // Push the nearest child last, on top.
      const std::size_t base = waiting;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        if (!(from[k] <= to[k])) continue;
        std::size_t place = waiting++;
        for (; place > base && stack[place - 1].from < from[k]; --place) stack[place] = stack[place - 1];
        stack[place] = {from[k], node.child[i], node.count[i]};
      }
    } else {
      for (std::uint32_t i = now.child; i < now.child + now.count; ++i) {
        const auto& [a, b, c] = triangles_[i];
        nearest = std::min(nearest, RayToTriangle(ray, vertices[a], vertices[b], vertices[c]));
      }
      if (nearest < kNoHit) limit = static_cast<float>((nearest - enter) * (1 + kFloatError)) + pad_m_;
    }
    do {
      if (waiting == 0) return nearest;
      now = stack[--waiting];
    } while (now.from > limit);
  }
}

}  // namespace coopdyn
