// SPDX-License-Identifier: MIT
#include "server/sensing/readings.h"

#include <algorithm>
#include <cmath>

#include "server/sensing/fan_cast.h"
#include "server/sensing/noise.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

namespace {

constexpr std::size_t kReadingGrain = 64;  // robots that one thread takes at a time
constexpr double kWorthThreads_us = 60;    // less work is done before another thread has woken up

/// About what the distances of one robot cost (docs/decisions.md has the figures measured).
double Cost_us(const SceneSensing::RobotType& type) {
  double cost = 0.1;
  for (const SensorFan& fan : type.fans) {
    for (const FanRay& ray : fan.rays()) cost += 0.02 * ray.limit_m;
  }
  return cost;
}

// The vision of one robot: a camera above its axle at its full height.
class Eye {
 public:
  Eye(const Frame& frame, int robot)
      : frame_(frame),
        cache_(SensingCache::Of(frame)),
        robot_(robot),
        self_(frame.scene->robots[static_cast<std::size_t>(robot)]),
        sensor_(self_.entry.model->target_sensor),
        X_WR_(cache_.field().pose(robot)),
        heading_rad_(Heading(X_WR_.q)) {}

  /// Appends the sighting of the thing `index` at `p_W` if it is in range and in view. `robot`: the robot
  /// that it is, -1 if none. Noise is keyed by `id`.
  void Look(int index, std::uint32_t id, const Vector3& p_W, int robot, NoiseKind distance_kind,
            NoiseKind bearing_kind, std::vector<Sighting>& seen) const {
    const double dx = p_W.x() - X_WR_.p.x();
    const double dy = p_W.y() - X_WR_.p.y();
    Sighting sighting{index, std::hypot(dx, dy), 0};
    if (sighting.distance_m > sensor_.max_range_m) return;
    if (!sensor_.see_through && IsHidden(p_W, robot)) return;
    if (sighting.distance_m > 0) sighting.bearing_rad = WrapAngle(std::atan2(dy, dx) - heading_rad_);
    NoiseKey key{frame_.seed, distance_kind, self_.id.value, id, frame_.step, 0};
    if (sensor_.distance_noise_stddev_m > 0) {
      const double noisy_m = sighting.distance_m + sensor_.distance_noise_stddev_m * GaussianNoise(key);
      sighting.distance_m = std::clamp(noisy_m, 0.0, sensor_.max_range_m);
    }
    if (sensor_.bearing_noise_stddev_rad > 0) {
      key.kind = bearing_kind;
      const double noise_rad = sensor_.bearing_noise_stddev_rad * GaussianNoise(key);
      sighting.bearing_rad = WrapAngle(sighting.bearing_rad + noise_rad);
    }
    seen.push_back(sighting);
  }

 private:
  bool IsHidden(const Vector3& p_W, int robot) const {
    const Vector3 eye_W = X_WR_ * Vector3(0, 0, self_.entry.model->height_m);
    const Vector3 way = p_W - eye_W;
    const double length_m = way.norm();
    if (length_m <= 0) return false;
    const ThingHit hit = cache_.Cast({eye_W, way / length_m}, length_m, robot_);
    // What lies behind the surface that was hit can only be the thing itself.
    return hit && (robot < 0 || hit.robot != robot);
  }

  const Frame& frame_;
  const SensingCache& cache_;
  const int robot_;
  const SceneRobot& self_;
  const TargetSensorModel& sensor_;
  const Pose& X_WR_;
  const double heading_rad_;
};

}  // namespace

std::span<const double> Distances(const Frame& frame, int robot) {
  return SensingCache::Of(frame).Distances(robot);
}

std::vector<Sighting> SeenTargets(const Frame& frame, int robot) {
  const Eye eye(frame, robot);
  std::vector<Sighting> seen;
  const std::vector<Target>& targets = frame.scene->targets;
  seen.reserve(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    eye.Look(static_cast<int>(i), targets[i].id.value, targets[i].p_WT, -1, NoiseKind::kTargetDistance,
             NoiseKind::kTargetBearing, seen);
  }
  return seen;
}

std::vector<Sighting> SeenRobots(const Frame& frame, int robot) {
  const Eye eye(frame, robot);
  const SensingCache& cache = SensingCache::Of(frame);
  std::vector<Sighting> seen;
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  for (int other = 0; other < static_cast<int>(robots.size()); ++other) {
    if (other == robot) continue;
    const SceneRobot& scene_robot = robots[static_cast<std::size_t>(other)];
    // The middle of its body; in the plane that is its axle's middle unless it leans.
    Vector3 p_W = cache.field().pose(other).p;
    p_W.z() += scene_robot.entry.model->height_m / 2;
    eye.Look(other, scene_robot.id.value, p_W, other, NoiseKind::kRobotDistance, NoiseKind::kRobotBearing,
             seen);
  }
  return seen;
}

void PrepareDistances(const Frame& frame, std::span<const int> robots, WorkerPool& pool) {
  const SensingCache& cache = SensingCache::Of(frame, &pool);
  const auto compute = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) cache.Distances(robots[i]);
  };
  const auto count = static_cast<double>(robots.size());
  if (robots.empty() || count * Cost_us(cache.scene().type(robots.front())) < kWorthThreads_us) {
    compute(0, robots.size());
  } else {
    pool.For(robots.size(), kReadingGrain, compute);
  }
}

std::vector<RaySegment> DistanceRays(const Frame& frame, int robot) {
  const SensingCache& cache = SensingCache::Of(frame);
  const std::vector<SensorFan>& fans = cache.scene().type(robot).fans;
  std::size_t count = 0;
  for (const SensorFan& fan : fans) count += fan.rays().size();
  std::vector<RaySegment> segments(count);
  for (const SensorFan& fan : fans) {
    FanCast cast(cache, robot, fan);
    const bool any = cast.Run();
    for (std::size_t k = 0; k < fan.rays().size(); ++k) {
      const FanRay& fan_ray = fan.rays()[k];
      const Ray ray = cast.ray_W(k);
      const double range_m = any ? cast.distance_m(k) : kNoHit;
      const bool hit = range_m < kNoHit;
      const Vector3 end = ray.origin + (hit ? range_m : fan_ray.limit_m) * ray.direction;
      segments[fan_ray.index] = {ray.origin, end, hit};
    }
  }
  return segments;
}

}  // namespace coopdyn
