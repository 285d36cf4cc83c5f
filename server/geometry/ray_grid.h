// SPDX-License-Identifier: MIT
// Nearest hit of a ray among many shapes: a walk through a uniform grid in the plane, shapes tested in 3D.
// Immutable once built; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/ray.h"
#include "server/geometry/uniform_grid.h"

namespace coopdyn {

/// A shape with its place in the world, and who it belongs to.
struct RayItem {
  Shape shape;
  Vector3 p_WG = Vector3::Zero();
  Matrix3 R_WG = Matrix3::Identity();
  std::uint32_t owner = 0;  // shapes of one owner can be ignored together
};

struct RayHit {
  double distance_m = kNoHit;
  std::uint32_t owner = 0;  // of the shape that was hit

  explicit operator bool() const { return distance_m < kNoHit; }
};

class RayGrid {
 public:
  /// @pre all poses finite, cell_m > 0.
  explicit RayGrid(std::vector<RayItem> items, double cell_m = 1.0);

  /// The nearest hit at `max_range_m` or nearer; shapes of `ignored_owner` let the ray pass.
  RayHit Cast(const Ray& ray_W, double max_range_m, std::uint32_t ignored_owner) const;

  const std::vector<RayItem>& items() const { return items_; }

 private:
  void Test(std::uint32_t item, const Ray& ray_W, std::uint32_t ignored_owner, RayHit& nearest) const;

  std::vector<RayItem> items_;
  std::vector<double> radii_m_;  // bounding spheres
  UniformGrid grid_;
};

}  // namespace coopdyn
