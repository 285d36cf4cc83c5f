// SPDX-License-Identifier: MIT
#include "server/sensing/fan_cast.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace coopdyn {

namespace {

// With more nearby robots than this per ray, each ray searches the grid along its own path.
constexpr std::size_t kManyPerRay = 24;
// Up to this many robots are tested one by one.
constexpr std::size_t kFewRobots = 8;
// Likewise with more nearby objects than this.
constexpr std::size_t kManyItems = 8;

inline Vector3 Turned(const Matrix3& R, const Vector3& v) {
  return R.col(0) * v.x() + R.col(1) * v.y() + R.col(2) * v.z();
}

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
  } else if (near > kFewRobots && has_map_) {
    Start();
    field.ForHulls(x, y, reach_W_.radius_m, [this](auto entries) { MeetManyRobots(entries); });
  } else if (near > 1) {
    field.ForHulls(x, y, reach_W_.radius_m, [this](auto entries) { MeetFewRobots(entries); });
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
  turn_ = fan_.TurnToMap(R_WR_);
  for (std::size_t k = 0; k < fan_.rays().size(); ++k) nearest_m_[k] = fan_.rays()[k].limit_m;
}

const FanCast::WorldRay& FanCast::GetRay(std::size_t k) {
  WorldRay& ray = rays_W_[k];
  if (const std::uint64_t bit = std::uint64_t{1} << k; (made_ & bit) == 0) {
    made_ |= bit;
    const FanRay& ray_R = fan_.rays()[k];
    ray.direction = Turned(R_WR_, ray_R.d_R);
    ray.origin = X_WR_.p + Turned(R_WR_, ray_R.p_RO);
  }
  return ray;
}

void FanCast::MeetFloor() {
  Start();
  for (std::size_t k = 0; k < fan_.rays().size(); ++k) {
    nearest_m_[k] = std::min(nearest_m_[k], RayToFloor(ray_W(k)));
  }
}

std::uint64_t FanCast::RaysNear(double dx, double dy, double radius_m) const {
  return has_map_ && radius_m <= fan_.thing_radius_m() ? fan_.Near(turn_, dx, dy) : fan_.all();
}

void FanCast::MeetFewRobots(std::span<const RobotField::Entry> entries) {
  for (const RobotField::Entry& entry : entries) {
    const double dx = entry.x - X_WR_.p.x(), dy = entry.y - X_WR_.p.y();
    const double reach_m = reach_W_.radius_m + entry.radius_m;
    if (dx * dx + dy * dy > reach_m * reach_m || entry.robot == robot_) continue;
    Start();
    MeetRobot(entry, RaysNear(dx, dy, entry.radius_m));
  }
}

void FanCast::MeetManyRobots(std::span<const RobotField::Entry> entries) {
  // Two passes over small chunks: the first has no branches, and leaves few entries for the second.
  constexpr std::size_t kChunk = 64;
  std::array<std::uint64_t, kChunk> rays;
  std::array<const RobotField::Entry*, kChunk> found;
  const double x = X_WR_.p.x(), y = X_WR_.p.y(), map_radius_m = fan_.thing_radius_m();
  for (; !entries.empty(); entries = entries.subspan(std::min(kChunk, entries.size()))) {
    std::size_t count = 0;
    for (const RobotField::Entry& entry : entries.first(std::min(kChunk, entries.size()))) {
      const std::uint64_t near = fan_.Near(turn_, entry.x - x, entry.y - y);
      rays[count] = entry.radius_m > map_radius_m ? fan_.all() : near;
      found[count] = &entry;
      count += rays[count] != 0 ? 1 : 0;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (found[i]->robot != robot_) MeetRobot(*found[i], rays[i]);
    }
  }
}

void FanCast::MeetRobot(const RobotField::Entry& entry, std::uint64_t rays) {
  if (entry.min_z > reach_W_.max_z || entry.max_z < reach_W_.min_z) return;
  const RobotHull& hull = cache_.scene().type(entry.robot).hull;
  const Pose& X_WR = cache_.field().pose(entry.robot);
  for (; rays != 0; rays &= rays - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(rays));
    const WorldRay& ray = GetRay(k);
    if (!entry.MayMeet(ray.origin, ray.direction, nearest_m_[k])) continue;
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
  if (near > kManyItems) {
    for (std::size_t k = 0; k < fan_.rays().size(); ++k) {
      nearest_m_[k] = std::min(nearest_m_[k], grid.Cast(ray_W(k), nearest_m_[k]));
    }
    return;
  }
  for (std::size_t n = 0; n < near; ++n) {
    const Vector3& p_W = grid.items()[items[n]].p_WG;
    std::uint64_t rays = RaysNear(p_W.x() - x, p_W.y() - y, grid.radius_m(items[n]));
    for (; rays != 0; rays &= rays - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(rays));
      grid.Test(items[n], ray_W(k), nearest_m_[k]);
    }
  }
}

}  // namespace coopdyn
