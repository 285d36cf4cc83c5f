// SPDX-License-Identifier: MIT
// A tree of boxes about triangles, four children a node, built so that rays meet few of them. Boxes are
// floats, a little larger than what they hold: they only decide which triangles are looked at. Constant once
// made; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/ray.h"

namespace coopdyn {

/// Distance along `ray` to a triangle, from either side; kNoHit if it misses.
double RayToTriangle(const Ray& ray, const Vector3& a, const Vector3& b, const Vector3& c);

class RayTree {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// Four boxes, side by side. An empty child has low > high.
  struct alignas(64) Node {
    std::array<std::array<float, 4>, 6> bounds;  // low x, y, z, high x, y, z
    std::array<std::uint32_t, 4> child;          // a node; of a leaf its first triangle
    std::array<std::uint32_t, 4> count;          // of triangles; 0: not a leaf

    bool is_empty(std::size_t i) const { return bounds[0][i] > bounds[3][i]; }
    Eigen::Vector3f low(std::size_t i) const { return {bounds[0][i], bounds[1][i], bounds[2][i]}; }
    Eigen::Vector3f high(std::size_t i) const { return {bounds[3][i], bounds[4][i], bounds[5][i]}; }
  };

  RayTree() = default;
  RayTree(std::span<const Vector3> vertices, std::span<const Triangle> triangles);

  /// The first is the root; none: there are no triangles.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// In the order of the leaves.
  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// Distance along `ray` to the nearest triangle from either side, m; kNoHit if it misses. `vertices`: those
  /// of the constructor.
  double Cast(const Ray& ray, std::span<const Vector3> vertices) const;

  /// Nodes that wait to be looked at, at most.
  static constexpr std::size_t kStack = 256;

 private:
  friend class RayTreeBuilder;

  Vector3 low_ = Vector3::Zero(), high_ = Vector3::Zero();  // of all
  float pad_m_ = 0;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace coopdyn
