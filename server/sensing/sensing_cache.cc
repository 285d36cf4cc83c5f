// SPDX-License-Identifier: MIT
#include "server/sensing/sensing_cache.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

// Values of FrameBuffers::progress.
constexpr std::uint8_t kNobody = 0, kInTheMaking = 1, kReady = 2;

}  // namespace

RayItem MakeRayItem(const Shape& shape, const Pose& X_WG) {
  return {shape, X_WG.p, X_WG.q.normalized().toRotationMatrix()};
}

FrameBuffers::FrameBuffers(const SceneSensing& scene)
    : progress(std::make_unique<std::atomic<std::uint8_t>[]>(scene.kept_sensors())),
      ranges(scene.ranges()),
      lists(scene.kept_sensors()) {}

const SensingCache& SensingCache::Of(const Frame& frame, WorkerPool* pool) {
  std::call_once(frame.cache_once, [&] { frame.cache = std::make_unique<SensingCache>(frame, pool); });
  return static_cast<const SensingCache&>(*frame.cache);
}

SensingCache::SensingCache(const Frame& frame, WorkerPool* pool)
    : frame_(frame), scene_(SceneSensing::Of(*frame.scene)), buffers_(scene_.TakeBuffers()) {
  for (std::size_t i = 0; i < scene_.kept_sensors(); ++i) {
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

std::span<const double> SensingCache::Values(int robot, std::size_t kept) const {
  if (kept >= scene_.type(robot).kept.size()) return {};
  const SceneSensing::Place& place = scene_.place(robot);
  Need(robot, place, kept);
  return PlaceOf(robot, place, kept);
}

std::span<const double> SensingCache::Distances(int robot) const {
  const SceneSensing::Place& place = scene_.place(robot);
  const SceneSensing::RobotType& type = scene_.type(robot);
  for (std::size_t kept = 0; kept < type.distance_sensors; ++kept) Need(robot, place, kept);
  return std::span<const double>(buffers_->ranges).subspan(place.first_range, type.ranges);
}

std::span<double> SensingCache::PlaceOf(int robot, const SceneSensing::Place& place, std::size_t kept) const {
  const KeptSensor& sensor = scene_.type(robot).kept[kept];
  if (sensor.has_list()) return buffers_->lists[place.first_kept + kept];
  return std::span(buffers_->ranges).subspan(place.first_range + sensor.first, sensor.count);
}

void SensingCache::Need(int robot, const SceneSensing::Place& place, std::size_t kept) const {
  std::atomic<std::uint8_t>& progress = buffers_->progress[place.first_kept + kept];
  std::uint8_t now = progress.load(std::memory_order_acquire);
  while (now != kReady) {
    if (now == kInTheMaking) {
      progress.wait(now, std::memory_order_acquire);
      now = progress.load(std::memory_order_acquire);
    } else if (progress.compare_exchange_strong(now, kInTheMaking, std::memory_order_acquire)) {
      const auto leave = [&progress](std::uint8_t as) {
        progress.store(as, std::memory_order_release);
        progress.notify_all();
      };
      try {
        Make(robot, place, kept);
      } catch (...) {  // e.g. out of memory: the next reader tries again
        leave(kNobody);
        throw;
      }
      return leave(kReady);
    }
  }
}

void SensingCache::Make(int robot, const SceneSensing::Place& place, std::size_t kept) const {
  const KeptSensor& sensor = scene_.type(robot).kept[kept];
  if (sensor.has_list()) buffers_->lists[place.first_kept + kept].resize(sensor.count);
  const std::span<double> values = PlaceOf(robot, place, kept);
  const auto compute = [&]<typename Kind>(const Kind& kind) {
    if constexpr (IsKept<Kind>) Compute(kind, sensor, *this, robot, values);
  };
  std::visit(compute, *sensor.kind);
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
