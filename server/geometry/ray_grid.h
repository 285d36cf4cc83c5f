// SPDX-License-Identifier: MIT
// Finds the nearest hit of a ray among many shapes of any size: walks a uniform grid in the plane and tests
// shapes in 3D. Thread-safe between builds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/ray.h"
#include "server/geometry/uniform_grid.h"

namespace coopdyn {

/// A shape with its pose in the world.
struct RayItem {
  Shape shape;
  Vector3 p_WG = Vector3::Zero();
  Matrix3 R_WG = Matrix3::Identity();
};

class RayGrid {
 public:
  RayGrid() = default;
  /// @pre all poses finite, cell_m > 0.
  explicit RayGrid(std::span<const RayItem> items, double cell_m = 1.0) { Build(items, cell_m); }
  void Build(std::span<const RayItem> items, double cell_m = 1.0);

  bool empty() const { return items_.empty(); }
  std::span<const RayItem> items() const { return items_; }
  /// Radius of the bounding sphere of item `index`.
  double radius_m(std::uint32_t index) const { return bounds_[index].radius_m; }

  /// Distance to the nearest hit within `max_range_m`; kNoHit if none.
  double Cast(const Ray& ray_W, double max_range_m) const;

  /// Lowers `nearest_m` to the distance of item `index` if the ray hits it nearer.
  void Test(std::uint32_t index, const Ray& ray_W, double& nearest_m) const;

  /// Writes the items whose bounds overlap `box` in the plane and [min_z, max_z] to `found`, by increasing
  /// index, if they fit. Returns their number, or found.size() + 1 if they do not fit.
  std::size_t FindNear(const Aabb2& box, double min_z, double max_z, std::span<std::uint32_t> found) const;
  /// All items whose bounds overlap `box` in the plane, by increasing index.
  std::vector<std::uint32_t> AllNear(const Aabb2& box) const;

 private:
  // Rejects most items without a test of their shapes.
  struct Bounds {
    Vector3 center_W = Vector3::Zero();
    double half_x = 0, half_y = 0, half_z = 0;  // half extents of the axis-aligned bounding box
    double radius_m = 0;                        // of the bounding sphere
  };

  std::vector<RayItem> items_;
  std::vector<Bounds> bounds_;  // parallel to items_
  std::vector<Aabb2> boxes_;    // parallel to items_
  UniformGrid grid_;
};

}  // namespace coopdyn
