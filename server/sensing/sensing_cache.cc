// SPDX-License-Identifier: MIT
#include "server/sensing/sensing_cache.h"

#include <algorithm>
#include <utility>

#include "server/sensing/distance_rays.h"
#include "server/sensing/noise.h"

namespace coopdyn {

namespace {

RayItem MakeItem(const Shape& shape, const Pose& X_WG, std::uint32_t owner) {
  return {shape, X_WG.p, X_WG.q.normalized().toRotationMatrix(), owner};
}

std::vector<RayItem> CollectItems(const Frame& frame) {
  const Scene& scene = *frame.scene;
  std::size_t count = scene.objects.size();
  for (const SceneRobot& robot : scene.robots) {
    for (const LinkModel& link : robot.entry.model->links) count += link.collisions.size();
  }
  std::vector<RayItem> items;
  items.reserve(count);
  for (const SceneObject& object : scene.objects) {
    items.push_back(MakeItem(object.object.shape, ObjectPose(frame, object), SensingCache::kNobody));
  }
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const int robot = static_cast<int>(i);
    const std::vector<LinkModel>& links = scene.robots[i].entry.model->links;
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (links[k].collisions.empty()) continue;
      const Pose X_WL = LinkPose(frame, robot, static_cast<int>(k));
      for (const LinkShape& collision : links[k].collisions) {
        items.push_back(MakeItem(collision.shape, X_WL * collision.X_LG, SensingCache::OwnerOf(robot)));
      }
    }
  }
  return items;
}

double AddNoise(double range_m, const DistanceSensorModel& sensor, const NoiseKey& key) {
  if (range_m == kNoHit || sensor.noise_stddev_m <= 0) return range_m;
  return std::clamp(range_m + sensor.noise_stddev_m * GaussianNoise(key), 0.0, sensor.max_range_m);
}

}  // namespace

const SensingCache& SensingCache::Of(const Frame& frame) {
  std::call_once(frame.cache_once, [&frame] { frame.cache = std::make_unique<SensingCache>(frame); });
  return static_cast<const SensingCache&>(*frame.cache);
}

SensingCache::SensingCache(const Frame& frame) : frame_(frame) {
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  robot_poses_.reserve(robots.size());
  robot_ranges_ = std::make_unique<RobotRanges[]>(robots.size());
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    robot_poses_.push_back(RobotPose(frame, static_cast<int>(i)));
    robot_ranges_[i].first = first;
    robot_ranges_[i].count = static_cast<std::uint32_t>(robots[i].entry.model->distance_sensors.size());
    first += robot_ranges_[i].count;
  }
  ranges_m_.resize(first);
}

const RayGrid& SensingCache::grid() const {
  std::call_once(grid_once_, [this] { grid_.emplace(CollectItems(frame_)); });
  return *grid_;
}

std::span<const double> SensingCache::Distances(int robot) const {
  RobotRanges& part = robot_ranges_[static_cast<std::size_t>(robot)];
  std::call_once(part.once, [&] {
    const SceneRobot& scene_robot = frame_.scene->robots[static_cast<std::size_t>(robot)];
    NoiseKey key{frame_.seed, NoiseKind::kDistance, scene_robot.id.value, 0, frame_.step, 0};
    double* range_m = ranges_m_.data() + part.first;
    for (const DistanceSensorModel& sensor : scene_robot.entry.model->distance_sensors) {
      const Pose X_WS = robot_pose(robot) * sensor.X_RS;
      double nearest_m = kNoHit;
      for (int ray = 0; ray < sensor.rays; ++ray) {
        const double limit_m = std::min(nearest_m, sensor.max_range_m);
        nearest_m = std::min(nearest_m, CastSensorRay(grid(), SensorRay(sensor, X_WS, ray), limit_m, robot));
      }
      ++key.sensor;
      *range_m++ = AddNoise(nearest_m, sensor, key);
    }
  });
  return {ranges_m_.data() + part.first, part.count};
}

}  // namespace coopdyn
