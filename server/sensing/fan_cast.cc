// SPDX-License-Identifier: MIT
#include "server/sensing/fan_cast.h"

#include <algorithm>

namespace coopdyn {

namespace {

// With more robots near than this per ray, each ray looks along its own way only.
constexpr std::size_t kManyPerRay = 24;
// With more objects near than this, too.
constexpr std::size_t kManyItems = 8;

}  // namespace

bool FanCast::Run() {
  reach_W_ = fan_.reach().Upright(X_WR_.p.z(), tilt_);
  if (reach_W_.min_z <= 0) MeetFloor();

  std::size_t near = 0;
  const RobotField& field = cache_.field();
  const double x = X_WR_.p.x(), y = X_WR_.p.y();
  field.ForHulls(x, y, reach_W_.radius_m, [&](auto entries) { near += entries.size(); });
  if (near > kManyPerRay * fan_.rays().size()) {
    MeetRobotsRayByRay();
  } else if (near > 1) {
    field.ForHulls(x, y, reach_W_.radius_m, [this](auto entries) { MeetRobots(entries); });
  }

  if (!cache_.scene().static_grid().empty()) MeetItems(cache_.scene().static_grid());
  if (!cache_.scene().movable().empty()) MeetItems(cache_.movable_grid());
  return started_;
}

Ray FanCast::ray_W(std::size_t k) {
  Start();
  const WorldRay& ray = GetRay(k);
  return {ray.origin, ray.direction};
}

void FanCast::Start() {
  if (started_) return;
  started_ = true;
  R_WR_ = X_WR_.q.toRotationMatrix();
  place_ = FanPlace(R_WR_, tilt_);
  for (std::size_t k = 0; k < fan_.rays().size(); ++k) nearest_m_[k] = fan_.rays()[k].limit_m;
}

const FanCast::WorldRay& FanCast::GetRay(std::size_t k) {
  WorldRay& ray = rays_W_[k];
  if (const std::uint64_t bit = std::uint64_t{1} << k; (made_ & bit) == 0) {
    made_ |= bit;
    const FanRay& ray_R = fan_.rays()[k];
    ray.origin = X_WR_.p + R_WR_ * ray_R.p_RO;
    ray.direction = R_WR_ * ray_R.d_R;
  }
  return ray;
}

void FanCast::MeetFloor() {
  Start();
  for (std::size_t k = 0; k < fan_.rays().size(); ++k) {
    nearest_m_[k] = std::min(nearest_m_[k], RayToFloor(ray_W(k)));
  }
}

void FanCast::MeetRobots(std::span<const RobotField::Entry> entries) {
  for (const RobotField::Entry& entry : entries) {
    const double dx = entry.x - X_WR_.p.x(), dy = entry.y - X_WR_.p.y();
    const double reach_m = reach_W_.radius_m + entry.radius_m;
    if (dx * dx + dy * dy > reach_m * reach_m || entry.robot == robot_) continue;
    if (entry.min_z > reach_W_.max_z || entry.max_z < reach_W_.min_z) continue;
    MeetRobot(entry, dx, dy);
  }
}

void FanCast::MeetRobot(const RobotField::Entry& entry, double dx, double dy) {
  Start();
  const SensorFan::Part part = fan_.Toward(place_, dx, dy, entry.radius_m);
  if (part.first == part.end) return;
  const RobotHull& hull = cache_.scene().type(entry.robot).hull;
  const HullPose X_WR(cache_.field().pose(entry.robot));
  const auto count = static_cast<std::uint32_t>(fan_.rays().size());
  for (std::uint32_t i = part.first; i < part.end; ++i) {
    const std::uint32_t k = i < count ? i : i - count;
    const WorldRay& ray = GetRay(k);
    hull.Cast(cache_.frame(), entry.robot, X_WR, {ray.origin, ray.direction}, nearest_m_[k]);
  }
}

void FanCast::MeetRobotsRayByRay() {
  Start();
  for (std::size_t k = 0; k < fan_.rays().size(); ++k) {
    const ThingHit hit = cache_.field().Cast(cache_.frame(), cache_.scene(), ray_W(k), nearest_m_[k], robot_);
    nearest_m_[k] = std::min(nearest_m_[k], hit.distance_m);
  }
}

void FanCast::MeetItems(const RayGrid& grid) {
  const double x = X_WR_.p.x(), y = X_WR_.p.y(), reach_m = reach_W_.radius_m;
  std::array<std::uint32_t, kManyItems> items;
  const std::size_t near = grid.FindNear({x - reach_m, y - reach_m, x + reach_m, y + reach_m}, reach_W_.min_z,
                                         reach_W_.max_z, items);
  if (near == 0) return;
  Start();
  const auto count = static_cast<std::uint32_t>(fan_.rays().size());
  if (near > kManyItems) {
    for (std::uint32_t k = 0; k < count; ++k) {
      nearest_m_[k] = std::min(nearest_m_[k], grid.Cast(ray_W(k), nearest_m_[k]));
    }
    return;
  }
  for (std::size_t n = 0; n < near; ++n) {
    const Vector3& p_W = grid.items()[items[n]].p_WG;
    const SensorFan::Part part = fan_.Toward(place_, p_W.x() - x, p_W.y() - y, grid.radius_m(items[n]));
    for (std::uint32_t i = part.first; i < part.end; ++i) {
      const std::uint32_t k = i < count ? i : i - count;
      grid.Test(items[n], ray_W(k), nearest_m_[k]);
    }
  }
}

}  // namespace coopdyn
