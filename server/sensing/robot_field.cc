// SPDX-License-Identifier: MIT
#include "server/sensing/robot_field.h"

#include <cmath>

namespace coopdyn {

namespace {

constexpr std::size_t kPlaceGrain = 256;  // robots per work unit of a thread
constexpr double kMinCell_m = 0.05;

}  // namespace

void RobotField::Build(const Frame& frame, const SceneSensing& scene, WorkerPool* pool) {
  const std::size_t count = scene.robots();
  poses_.resize(count);
  centers_.resize(count);
  by_robot_.resize(count);
  entries_.resize(count);
  const auto place = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const int robot = static_cast<int>(i);
      poses_[i] = RobotPose(frame, robot);
      const Vector3& p = poses_[i].p;
      const Extent hull = scene.type(robot).hull.Bounds(frame, robot, poses_[i]);
      centers_[i] = {p.x(), p.y()};
      by_robot_[i] = {p.x(), p.y(), hull.radius_m, hull.min_z, hull.max_z, robot};
    }
  };
  const auto sort = [&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) entries_[k] = by_robot_[grid_.order()[k]];
  };
  const auto run = [&](const auto& work) {
    if (pool != nullptr && count > 4 * kPlaceGrain) {
      pool->For(count, kPlaceGrain, work);
    } else {
      work(0, count);
    }
  };
  run(place);
  wide_.clear();
  hull_radius_m_ = 0;
  for (const Entry& entry : by_robot_) {
    if (entry.radius_m > scene.max_hull_radius_m()) {
      wide_.push_back(entry);
    } else {
      hull_radius_m_ = std::max(hull_radius_m_, entry.radius_m);
    }
  }
  grid_.Build(centers_, std::max(kMinCell_m, 2 * hull_radius_m_));
  run(sort);
}

ThingHit RobotField::Cast(const Frame& frame, const SceneSensing& scene, const Ray& ray_W, double nearest_m,
                          int ignored_robot) const {
  ThingHit nearest{kNoHit, -1};
  double limit_m = nearest_m;
  const auto test = [&](std::span<const Entry> entries) {
    for (const Entry& entry : entries) {
      if (entry.robot == ignored_robot || !entry.MayMeet(ray_W.origin, ray_W.direction, limit_m)) continue;
      const double before_m = limit_m;
      scene.type(entry.robot).hull.Cast(frame, entry.robot, pose(entry.robot), ray_W, limit_m);
      if (limit_m < before_m) nearest = {limit_m, entry.robot};
    }
  };
  test(wide_);
  grid_.ForRunsAlong(
      {ray_W.origin.x(), ray_W.origin.y()}, {ray_W.direction.x(), ray_W.direction.y()}, hull_radius_m_,
      [&] { return limit_m; }, [&](std::uint32_t first, std::uint32_t end) { test(Entries(first, end)); });
  return nearest;
}

}  // namespace coopdyn
