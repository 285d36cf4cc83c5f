// SPDX-License-Identifier: MIT
#include "server/sensing/sensing_cache.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/sensing/fan_cast.h"
#include "server/sensing/noise.h"

namespace coopdyn {

namespace {

// Values of FrameBuffers::progress.
constexpr std::uint8_t kNobody = 0, kInTheMaking = 1, kReady = 2;

double AddNoise(double range_m, const DistanceSensorModel& sensor, const NoiseKey& key) {
  if (range_m == kNoHit || sensor.noise_stddev_m <= 0) return range_m;
  return std::clamp(range_m + sensor.noise_stddev_m * GaussianNoise(key), 0.0, sensor.max_range_m);
}

}  // namespace

RayItem MakeRayItem(const Shape& shape, const Pose& X_WG) {
  return {shape, X_WG.p, X_WG.q.normalized().toRotationMatrix()};
}

FrameBuffers::FrameBuffers(const SceneSensing& scene)
    : progress(std::make_unique<std::atomic<std::uint8_t>[]>(scene.robots())),
      ranges_m(scene.first_range(static_cast<int>(scene.robots()))) {}

const SensingCache& SensingCache::Of(const Frame& frame, WorkerPool* pool) {
  std::call_once(frame.cache_once, [&] { frame.cache = std::make_unique<SensingCache>(frame, pool); });
  return static_cast<const SensingCache&>(*frame.cache);
}

SensingCache::SensingCache(const Frame& frame, WorkerPool* pool)
    : frame_(frame), scene_(SceneSensing::Of(*frame.scene)), buffers_(scene_.TakeBuffers()) {
  for (std::size_t i = 0; i < scene_.robots(); ++i) {
    buffers_->progress[i].store(kNobody, std::memory_order_relaxed);
  }
  buffers_->field.Build(frame, scene_, pool);
}

SensingCache::~SensingCache() {
  scene_.GiveBuffers(std::move(buffers_));
}

const RayGrid& SensingCache::movable_grid() const {
  std::call_once(movable_once_, [this] {
    std::vector<RayItem>& items = buffers_->movable_items;
    items.clear();
    for (const int index : scene_.movable()) {
      const SceneObject& object = frame_.scene->objects[static_cast<std::size_t>(index)];
      items.push_back(MakeRayItem(object.object.shape, ObjectPose(frame_, object)));
    }
    buffers_->movable_grid.Build(items);
  });
  return buffers_->movable_grid;
}

std::span<const double> SensingCache::Distances(int robot) const {
  std::atomic<std::uint8_t>& progress = buffers_->progress[static_cast<std::size_t>(robot)];
  std::uint8_t now = progress.load(std::memory_order_acquire);
  if (now == kNobody && progress.compare_exchange_strong(now, kInTheMaking, std::memory_order_acquire)) {
    MakeRanges(robot);
    progress.store(kReady, std::memory_order_release);
    progress.notify_all();
    now = kReady;
  }
  while (now != kReady) {
    progress.wait(now, std::memory_order_acquire);
    now = progress.load(std::memory_order_acquire);
  }
  const std::uint32_t first = scene_.first_range(robot);
  return std::span<const double>(buffers_->ranges_m).subspan(first, scene_.first_range(robot + 1) - first);
}

void SensingCache::MakeRanges(int robot) const {
  double* ranges_m = buffers_->ranges_m.data() + scene_.first_range(robot);
  const SceneRobot& scene_robot = frame_.scene->robots[static_cast<std::size_t>(robot)];
  const std::vector<DistanceSensorModel>& sensors = scene_robot.entry.model->distance_sensors;
  std::fill(ranges_m, ranges_m + sensors.size(), kNoHit);
  for (const SensorFan& fan : scene_.type(robot).fans) {
    FanCast cast(*this, robot, fan);
    if (!cast.Run()) continue;
    for (std::size_t k = 0; k < fan.rays().size(); ++k) {
      double& range_m = ranges_m[fan.rays()[k].sensor];
      range_m = std::min(range_m, cast.distance_m(k));
    }
  }
  NoiseKey key{frame_.seed, NoiseKind::kDistance, scene_robot.id.value, 0, frame_.step, 0};
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    ++key.sensor;
    ranges_m[k] = AddNoise(ranges_m[k], sensors[k], key);
  }
}

ThingHit SensingCache::Cast(const Ray& ray_W, double max_range_m, int ignored_robot) const {
  ThingHit nearest{scene_.static_grid().Cast(ray_W, max_range_m), -1};
  const auto limit = [&] { return std::min(nearest.distance_m, max_range_m); };
  if (!scene_.movable().empty())
    nearest.distance_m = std::min(nearest.distance_m, movable_grid().Cast(ray_W, limit()));
  const ThingHit robot = field().Cast(frame_, scene_, ray_W, std::nextafter(limit(), kNoHit), ignored_robot);
  return robot.distance_m < nearest.distance_m ? robot : nearest;
}

}  // namespace coopdyn
