// SPDX-License-Identifier: MIT
// The distance module: ranges by rays. The readings are costly, so the frame's cache keeps them.
#include <algorithm>

#include "server/sensing/fan_cast.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"
#include "server/state/noise.h"

namespace coopdyn {

namespace {

constexpr std::size_t kReadingGrain = 64;  // robots per work unit of a thread
constexpr double kWorthThreads_us = 60;    // less work is done before another thread wakes up

/// Approximate cost of one robot's distances (measured figures: docs/decisions.md).
double Cost_us(const SceneSensing::RobotType& type) {
  double cost = 0.1;
  for (const KeptSensor& sensor : type.kept) {
    for (const SensorFan& fan : sensor.fans) {
      for (const FanRay& ray : fan.rays()) cost += 0.02 * ray.limit_m;
    }
  }
  return cost;
}

double AddNoise(double range_m, const SectorModel& sector, const NoiseKey& key) {
  if (sector.noise_stddev_m <= 0 || range_m == kNoHit) return range_m;
  return std::clamp(range_m + sector.noise_stddev_m * GaussianNoise(key), 0.0, sector.max_range_m);
}

}  // namespace

void Compute(const DistanceModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> ranges_m) {
  std::fill(ranges_m.begin(), ranges_m.end(), kNoHit);
  bool near = false;
  for (const SensorFan& fan : sensor.fans) {
    FanCast cast(cache, robot, fan);
    if (!cast.Run()) continue;
    near = true;
    for (std::size_t k = 0; k < fan.rays().size(); ++k) {
      double& range_m = ranges_m[fan.rays()[k].sector];
      range_m = std::min(range_m, cast.distance_m(k));
    }
  }
  if (!near) return;
  const Frame& frame = cache.frame();
  const RobotId id = frame.scene->robots[static_cast<std::size_t>(robot)].id;
  NoiseKey key{frame.seed, NoiseKind::kDistance, id.value, sensor.first, frame.step, 0};
  for (std::size_t k = 0; k < ranges_m.size(); ++k) {
    ++key.sensor;
    ranges_m[k] = AddNoise(ranges_m[k], model.sectors[k], key);
  }
}

std::span<const double> Distances(const Frame& frame, int robot, std::size_t number) {
  return SensingCache::Of(frame).ValuesOf<DistanceModel>(robot, number);
}

std::span<const double> Distances(const Frame& frame, int robot) {
  return SensingCache::Of(frame).Distances(robot);
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
  std::vector<RaySegment> segments;
  for (const KeptSensor& sensor : cache.scene().type(robot).kept) {
    for (const SensorFan& fan : sensor.fans) {
      FanCast cast(cache, robot, fan);
      const bool any = cast.Run();
      for (std::size_t k = 0; k < fan.rays().size(); ++k) {
        const Ray ray = cast.ray_W(k);
        const double range_m = any ? cast.distance_m(k) : kNoHit;
        const bool hit = range_m < kNoHit;
        const double length_m = hit ? range_m : fan.rays()[k].limit_m;
        segments.push_back({ray.origin, ray.origin + length_m * ray.direction, hit});
      }
    }
  }
  return segments;
}

}  // namespace coopdyn
