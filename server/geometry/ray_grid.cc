// SPDX-License-Identifier: MIT
#include "server/geometry/ray_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coopdyn {

namespace {

// Padding of the shapes' boxes, so that rounding at a cell's border cannot lose a shape.
constexpr double kPad_m = 1e-6;

// The walk along one axis of the grid.
struct AxisWalk {
  int cell = 0;        // the current cell
  int step = 0;        // −1, 0 or 1
  double next = 0;     // ray parameter where the ray leaves `cell`
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

// Clips [from, to] to the t for which origin + t * direction lies in [min, max].
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

// True if the interval from 0 to speed * length misses [center − half, center + half].
bool IsApart(double center, double half, double speed, double length) {
  if (std::abs(center) <= half) return false;
  return center > 0 ? speed <= 0 || speed * length < center - half
                    : speed >= 0 || speed * length > center + half;
}

}  // namespace

void RayGrid::Build(std::span<const RayItem> items, double cell_m) {
  items_.assign(items.begin(), items.end());
  bounds_.clear();
  boxes_.clear();
  for (const RayItem& item : items_) {
    const Vector3 half = HalfExtents(item.shape, item.R_WG) + Vector3::Constant(kPad_m);
    const Vector3 min = item.p_WG - half, max = item.p_WG + half;
    bounds_.push_back({item.p_WG, half.x(), half.y(), half.z(), BoundingRadius(item.shape) + kPad_m});
    boxes_.push_back({min.x(), min.y(), max.x(), max.y()});
  }
  grid_.Build(boxes_, cell_m);
}

double RayGrid::Cast(const Ray& ray_W, double max_range_m) const {
  const double limit = std::nextafter(max_range_m, kNoHit);
  double nearest = limit;
  for (const std::uint32_t item : grid_.large_items()) Test(item, ray_W, nearest);

  const Vector3& o = ray_W.origin;
  // A component too small to cross a cell within any range would only overflow.
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
        if (item != last) Test(item, ray_W, nearest);
        last = item;
      }
      AxisWalk& sooner = x.next < y.next ? x : y;
      if (sooner.step == 0 || sooner.next > std::min(to, nearest)) break;
      sooner.Advance();
    }
  }
  return nearest < limit ? nearest : kNoHit;
}

void RayGrid::Test(std::uint32_t index, const Ray& ray_W, double& nearest_m) const {
  // Is the ray separated from the item's box along x, along y, across the ray in the plane, or in height?
  const Bounds& bounds = bounds_[index];
  const Vector3& o = ray_W.origin;
  const Vector3& d = ray_W.direction;
  const double dx = bounds.center_W.x() - o.x(), dy = bounds.center_W.y() - o.y();
  const double across = dx * d.y() - dy * d.x();
  if (std::abs(across) > bounds.half_x * std::abs(d.y()) + bounds.half_y * std::abs(d.x())) return;
  if (IsApart(dx, bounds.half_x, d.x(), nearest_m) || IsApart(dy, bounds.half_y, d.y(), nearest_m)) return;
  if (IsApart(bounds.center_W.z() - o.z(), bounds.half_z, d.z(), nearest_m)) return;
  const RayItem& item = items_[index];
  const Ray ray_G{item.R_WG.transpose() * (ray_W.origin - item.p_WG),
                  item.R_WG.transpose() * ray_W.direction};
  nearest_m = std::min(nearest_m, RayToShape(ray_G, item.shape));
}

std::size_t RayGrid::FindNear(const Aabb2& box, double min_z, double max_z,
                              std::span<std::uint32_t> found) const {
  std::size_t count = 0;
  grid_.VisitOverlaps(boxes_, box, [&](std::uint32_t item) {
    const Bounds& bounds = bounds_[item];
    if (bounds.center_W.z() - bounds.half_z > max_z || bounds.center_W.z() + bounds.half_z < min_z)
      return true;
    if (count < found.size()) found[count] = item;
    return ++count <= found.size();
  });
  if (count <= found.size()) std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

std::vector<std::uint32_t> RayGrid::AllNear(const Aabb2& box) const {
  std::vector<std::uint32_t> items;
  grid_.FindOverlaps(boxes_, box, items);
  return items;
}

}  // namespace coopdyn
