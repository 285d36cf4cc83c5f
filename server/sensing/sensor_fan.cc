// SPDX-License-Identifier: MIT
#include "server/sensing/sensor_fan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/base/portable_math.h"
#include "server/geometry/ray.h"

namespace coopdyn {

std::vector<SensorFan> SensorFan::MakeAll(const DistanceModel& model, double thing_radius_m) {
  std::vector<FanRay> rays;
  for (std::size_t k = 0; k < model.sectors.size(); ++k) {
    const SectorModel& sector = model.sectors[k];
    for (int i = 0; i < sector.rays; ++i) {
      // Spread evenly from the sector's right edge to its left one.
      const double angle_rad =
          sector.rays > 1 ? sector.opening_rad * (static_cast<double>(i) / (sector.rays - 1) - 0.5) : 0;
      const auto [sine, cosine] = portable::SinCos(angle_rad);
      rays.push_back({sector.X_RS.p, sector.X_RS.q * Vector3(cosine, sine, 0),
                      std::nextafter(sector.max_range_m, kNoHit), static_cast<std::uint32_t>(k)});
    }
  }
  std::vector<SensorFan> fans;
  for (std::size_t first = 0; first < rays.size(); first += kMaxRays) {
    const std::size_t end = std::min(rays.size(), first + kMaxRays);
    fans.push_back(SensorFan(
        {rays.begin() + static_cast<std::ptrdiff_t>(first), rays.begin() + static_cast<std::ptrdiff_t>(end)},
        thing_radius_m));
  }
  return fans;
}

SensorFan::SensorFan(std::vector<FanRay> rays, double thing_radius_m)
    : rays_(std::move(rays)), thing_radius_m_(thing_radius_m) {
  for (const FanRay& ray : rays_) {
    const Vector3 end = ray.p_RO + ray.limit_m * ray.d_R;
    for (const Vector3& p : {ray.p_RO, end}) reach_.Include(portable::Hypot(p.x(), p.y()), p.z(), p.z());
  }
  DrawMap();
}

SensorFan::Turn SensorFan::TurnToMap(const Matrix3& R_WR) const {
  const double length = std::sqrt(R_WR(0, 0) * R_WR(0, 0) + R_WR(1, 0) * R_WR(1, 0));
  if (length <= 0) return {cells_per_m_, 0};
  return {cells_per_m_ * R_WR(0, 0) / length, cells_per_m_ * R_WR(1, 0) / length};
}

void SensorFan::DrawMap() {
  // Seen from above, tilt moves a point of a ray by its height times the tilt, and by a part of its distance
  // that is quadratic in the tilt.
  const double lean_m = kMaxTilt * std::max(std::abs(reach_.min_z), std::abs(reach_.max_z)) +
                        kMaxTilt * kMaxTilt * reach_.radius_m;
  const double near_m = thing_radius_m_ + lean_m + Extent::kPad_m;
  // One extra cell on each side, and room for a thing anywhere in its cell.
  const double cell_m = 2 * (reach_.radius_m + near_m) / (kCells - 4);
  const double half_m = cell_m * kCells / 2;
  cells_per_m_ = 1 / cell_m;
  map_.assign(kCells * kCells, 0);
  // A thing may stand anywhere in its cell.
  const double most_m = near_m + cell_m * std::numbers::sqrt2 / 2;
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    const FanRay& ray = rays_[k];
    const double length_m = ray.limit_m * portable::Hypot(ray.d_R.x(), ray.d_R.y());
    const double ux = length_m > 0 ? ray.d_R.x() * ray.limit_m / length_m : 1;
    const double uy = length_m > 0 ? ray.d_R.y() * ray.limit_m / length_m : 0;
    for (std::size_t row = 0; row < kCells; ++row) {
      const double y = (static_cast<double>(row) + 0.5) * cell_m - half_m - ray.p_RO.y();
      for (std::size_t column = 0; column < kCells; ++column) {
        const double x = (static_cast<double>(column) + 0.5) * cell_m - half_m - ray.p_RO.x();
        const double along = x * ux + y * uy;
        const double beyond = along - std::clamp(along, 0.0, length_m);
        const double across = x * uy - y * ux;
        if (beyond * beyond + across * across > most_m * most_m) continue;
        map_[row * kCells + column] |= std::uint64_t{1} << k;
      }
    }
  }
}

}  // namespace coopdyn
