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
  std::uint32_t owner = 0;  // shapes of one owner can be ignored together; 0: nobody's
};

struct RayHit {
  double distance_m = kNoHit;
  std::uint32_t owner = 0;  // of the shape that was hit

  explicit operator bool() const { return distance_m < kNoHit; }
};

class RayGrid {
 public:
  /// Fastest if the items of one owner follow each other and lie close together. @pre all poses finite,
  /// cell_m > 0.
  explicit RayGrid(std::vector<RayItem> items, double cell_m = 1.0);

  /// The nearest hit at `max_range_m` or nearer; shapes of `ignored_owner` let the ray pass.
  RayHit Cast(const Ray& ray_W, double max_range_m, std::uint32_t ignored_owner) const;

  const std::vector<RayItem>& items() const { return items_; }

 private:
  // What decides about most items without looking at their shapes.
  struct Bounds {
    Vector3 center_W = Vector3::Zero();
    double radius_m = 0;
    double min_z = 0, max_z = 0;
  };
  // Items that follow each other and have one owner: in the grid they are one.
  struct Group {
    Bounds bounds;
    std::uint32_t owner = 0;
    std::uint32_t first = 0, end = 0;  // in items_
  };
  struct Query {
    Ray ray_W;
    double min_z = 0, max_z = 0;  // that the ray reaches within its range
    std::uint32_t ignored_owner = 0;

    bool MayMeet(const Bounds& bounds, double nearest_m) const;
  };
  Group MakeGroup(std::uint32_t first, std::uint32_t end, Aabb2& box) const;
  void Test(const Group& group, const Query& query, RayHit& nearest) const;

  std::vector<RayItem> items_;
  std::vector<Bounds> bounds_;  // of items_
  std::vector<Group> groups_;
  UniformGrid grid_;
};

}  // namespace coopdyn
