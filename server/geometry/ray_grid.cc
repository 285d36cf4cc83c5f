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
  boxes.reserve(items_.size());
  radii_m_.reserve(items_.size());
  for (const RayItem& item : items_) {
    const Vector3 half = HalfExtents(item.shape, item.R_WG) + Vector3::Constant(kPad_m);
    boxes.push_back({item.p_WG.x() - half.x(), item.p_WG.y() - half.y(), item.p_WG.x() + half.x(),
                     item.p_WG.y() + half.y()});
    radii_m_.push_back(BoundingRadius(item.shape));
  }
  grid_.Build(boxes, cell_m);
}

RayHit RayGrid::Cast(const Ray& ray_W, double max_range_m, std::uint32_t ignored_owner) const {
  RayHit nearest{std::nextafter(max_range_m, kNoHit), 0};
  const double limit = nearest.distance_m;
  for (const std::uint32_t item : grid_.large_items()) Test(item, ray_W, ignored_owner, nearest);

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
      for (const std::uint32_t item : grid_.Cell(x.cell, y.cell)) {
        if (item != last) Test(item, ray_W, ignored_owner, nearest);
        last = item;
      }
      AxisWalk& sooner = x.next < y.next ? x : y;
      if (sooner.step == 0 || sooner.next > std::min(to, nearest.distance_m)) break;
      sooner.Advance();
    }
  }
  return nearest.distance_m < limit ? nearest : RayHit{};
}

void RayGrid::Test(std::uint32_t index, const Ray& ray_W, std::uint32_t ignored_owner,
                   RayHit& nearest) const {
  const RayItem& item = items_[index];
  if (item.owner == ignored_owner) return;
  const double radius = radii_m_[index];
  const Vector3 to_center = item.p_WG - ray_W.origin;
  const double along = to_center.dot(ray_W.direction);
  if (along < -radius || along - radius > nearest.distance_m) return;
  if (to_center.squaredNorm() - along * along > radius * radius + kPad_m) return;
  const Ray ray_G{item.R_WG.transpose() * -to_center, item.R_WG.transpose() * ray_W.direction};
  const double distance = RayToShape(ray_G, item.shape);
  if (distance < nearest.distance_m) nearest = {distance, item.owner};
}

}  // namespace coopdyn
