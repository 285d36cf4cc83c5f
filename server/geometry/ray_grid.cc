// SPDX-License-Identifier: MIT
#include "server/geometry/ray_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coopdyn {

namespace {

// Boxes are a little larger than their shapes, so that rounding at a cell's border cannot lose one.
constexpr double kPad_m = 1e-6;

// The walk along one axis of the grid.
struct AxisWalk {
  int cell = 0;        // where the walk is now
  int step = 0;        // −1, 0 or 1
  double next = 0;     // ray parameter at which it leaves `cell`
  double advance = 0;  // ray parameter per cell

  AxisWalk(double origin, double direction, double start, double min, double cell_m, int cells) {
    cell = std::clamp(static_cast<int>(std::floor((start - min) / cell_m)), 0, cells - 1);
    if (direction == 0) {
      next = kNoHit;
      return;
    }
    step = direction > 0 ? 1 : -1;
    next = (min + (cell + (step > 0 ? 1 : 0)) * cell_m - origin) / direction;
    advance = cell_m / std::abs(direction);
  }
  void Advance() {
    cell += step;
    next += advance;
  }
};

// Clips [from, to] to where origin + t * direction lies in [min, max].
void ClipToRange(double origin, double direction, double min, double max, double& from, double& to) {
  if (direction == 0) {
    if (origin < min || origin > max) to = -1;
    return;
  }
  const double a = (min - origin) / direction;
  const double b = (max - origin) / direction;
  from = std::max(from, std::min(a, b));
  to = std::min(to, std::max(a, b));
}

}  // namespace

RayGrid::RayGrid(std::vector<RayItem> items, double cell_m) : items_(std::move(items)) {
  std::vector<Aabb2> boxes;
  bounds_.reserve(items_.size());
  for (const RayItem& item : items_) {
    const double half_z = HalfExtents(item.shape, item.R_WG).z() + kPad_m;
    bounds_.push_back(
        {item.p_WG, BoundingRadius(item.shape), item.p_WG.z() - half_z, item.p_WG.z() + half_z});
  }
  const auto count = static_cast<std::uint32_t>(items_.size());
  for (std::uint32_t first = 0, end = 0; first < count; first = end) {
    end = first + 1;
    while (items_[first].owner != 0 && end < count && items_[end].owner == items_[first].owner) ++end;
    groups_.push_back(MakeGroup(first, end, boxes.emplace_back()));
  }
  grid_.Build(boxes, cell_m);
}

RayGrid::Group RayGrid::MakeGroup(std::uint32_t first, std::uint32_t end, Aabb2& box) const {
  Vector3 min = Vector3::Constant(kNoHit), max = -min;
  for (std::uint32_t i = first; i < end; ++i) {
    const Vector3 half = HalfExtents(items_[i].shape, items_[i].R_WG) + Vector3::Constant(kPad_m);
    min = min.cwiseMin(items_[i].p_WG - half);
    max = max.cwiseMax(items_[i].p_WG + half);
  }
  box = {min.x(), min.y(), max.x(), max.y()};
  Group group{{(min + max) / 2, 0, min.z(), max.z()}, items_[first].owner, first, end};
  for (std::uint32_t i = first; i < end; ++i) {
    const double reach_m = (items_[i].p_WG - group.bounds.center_W).norm() + bounds_[i].radius_m;
    group.bounds.radius_m = std::max(group.bounds.radius_m, reach_m);
  }
  return group;
}

RayHit RayGrid::Cast(const Ray& ray_W, double max_range_m, std::uint32_t ignored_owner) const {
  RayHit nearest{std::nextafter(max_range_m, kNoHit), 0};
  const double limit = nearest.distance_m;
  const double start_z = ray_W.origin.z();
  const double end_z = ray_W.direction.z() == 0 ? start_z : start_z + ray_W.direction.z() * limit;
  const Query query{ray_W, std::min(start_z, end_z), std::max(start_z, end_z), ignored_owner};
  for (const std::uint32_t group : grid_.large_items()) Test(groups_[group], query, nearest);

  const Vector3& o = ray_W.origin;
  // A component too small to cross a cell within any range would only make the arithmetic overflow.
  const double dx = std::abs(ray_W.direction.x()) < 1e-12 ? 0 : ray_W.direction.x();
  const double dy = std::abs(ray_W.direction.y()) < 1e-12 ? 0 : ray_W.direction.y();
  const double max_x = grid_.min_x() + grid_.columns() * grid_.cell_m();
  const double max_y = grid_.min_y() + grid_.rows() * grid_.cell_m();
  double from = 0, to = max_range_m;
  ClipToRange(o.x(), dx, grid_.min_x(), max_x, from, to);
  ClipToRange(o.y(), dy, grid_.min_y(), max_y, from, to);

  if (from <= to && grid_.columns() > 0 && grid_.rows() > 0) {
    AxisWalk x(o.x(), dx, o.x() + from * dx, grid_.min_x(), grid_.cell_m(), grid_.columns());
    AxisWalk y(o.y(), dy, o.y() + from * dy, grid_.min_y(), grid_.cell_m(), grid_.rows());
    std::uint32_t last = ~std::uint32_t{0};
    while (x.cell >= 0 && x.cell < grid_.columns() && y.cell >= 0 && y.cell < grid_.rows()) {
      for (const std::uint32_t group : grid_.Cell(x.cell, y.cell)) {
        if (group != last) Test(groups_[group], query, nearest);
        last = group;
      }
      AxisWalk& sooner = x.next < y.next ? x : y;
      if (sooner.step == 0 || sooner.next > std::min(to, nearest.distance_m)) break;
      sooner.Advance();
    }
  }
  return nearest.distance_m < limit ? nearest : RayHit{};
}

bool RayGrid::Query::MayMeet(const Bounds& bounds, double nearest_m) const {
  if (bounds.min_z > max_z || bounds.max_z < min_z) return false;
  const double radius = bounds.radius_m;
  const Vector3 to_center = bounds.center_W - ray_W.origin;
  const double along = to_center.dot(ray_W.direction);
  if (along < -radius || along - radius > nearest_m) return false;
  return to_center.squaredNorm() - along * along <= radius * radius + kPad_m;
}

void RayGrid::Test(const Group& group, const Query& query, RayHit& nearest) const {
  if (group.owner == query.ignored_owner || !query.MayMeet(group.bounds, nearest.distance_m)) return;
  for (std::uint32_t i = group.first; i < group.end; ++i) {
    if (!query.MayMeet(bounds_[i], nearest.distance_m)) continue;
    const RayItem& item = items_[i];
    const Ray ray_G{item.R_WG.transpose() * (query.ray_W.origin - item.p_WG),
                    item.R_WG.transpose() * query.ray_W.direction};
    const double distance = RayToShape(ray_G, item.shape);
    if (distance < nearest.distance_m) nearest = {distance, item.owner};
  }
}

}  // namespace coopdyn
