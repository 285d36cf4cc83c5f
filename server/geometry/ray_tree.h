// SPDX-License-Identifier: MIT
// A bounding-volume hierarchy of triangles with four children per node, built so that rays hit few boxes.
// Boxes are floats, slightly enlarged: they only select the triangles to test. Immutable; thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/ray.h"

namespace coopdyn {

/// Distance along `ray` to a triangle from either side; kNoHit if the ray misses.
double RayToTriangle(const Ray& ray, const Vector3& a, const Vector3& b, const Vector3& c);

class RayTree {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// Four boxes, side by side. An empty child has low > high.
  struct alignas(64) Node {
    std::array<std::array<float, 4>, 6> bounds;  // low x, y, z, high x, y, z
    std::array<std::uint32_t, 4> child;          // index of a node; for a leaf, of its first triangle
    std::array<std::uint32_t, 4> count;          // number of triangles; 0: not a leaf

    bool is_empty(std::size_t i) const { return bounds[0][i] > bounds[3][i]; }
    Eigen::Vector3f low(std::size_t i) const { return {bounds[0][i], bounds[1][i], bounds[2][i]}; }
    Eigen::Vector3f high(std::size_t i) const { return {bounds[3][i], bounds[4][i], bounds[5][i]}; }
  };

  RayTree() = default;
  RayTree(std::span<const Vector3> vertices, std::span<const Triangle> triangles);

  /// The root first. Empty if there are no triangles.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// In the order of the leaves.
  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// Distance along `ray` to the nearest triangle from either side, m; kNoHit if the ray misses. `vertices`:
  /// the same as in the constructor.
  double Cast(const Ray& ray, std::span<const Vector3> vertices) const;

  /// Maximum number of pending nodes during a traversal.
  static constexpr std::size_t kStack = 256;

 private:
  friend class RayTreeBuilder;

  Vector3 low_ = Vector3::Zero(), high_ = Vector3::Zero();  // bounds of all triangles
  float pad_m_ = 0;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace coopdyn
