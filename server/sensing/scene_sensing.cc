// SPDX-License-Identifier: MIT
#include "server/sensing/scene_sensing.h"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>

#include "server/sensing/sensing_cache.h"

namespace coopdyn {

const SceneSensing& SceneSensing::Of(const Scene& scene) {
  return static_cast<const SceneSensing&>(
      scene.cache.Get([&scene] { return std::make_unique<const SceneSensing>(scene); }));
}

SceneSensing::RobotType::RobotType(const RobotModel& model) : hull(model) {
  for (std::size_t i = 0; i < model.sensors.size(); ++i) {
    const auto keep = [&]<typename Kind>(const Kind& kind) {
      if constexpr (IsKept<Kind>) {
        KeptSensor sensor{&model.sensors[i].kind,
                          static_cast<std::uint32_t>(model.NumberOf(i)),
                          0,
                          static_cast<std::uint32_t>(ValueCount(kind)),
                          {}};
        if (!sensor.has_list()) {
          sensor.first = ranges;
          ranges += sensor.count;
          ++distance_sensors;
        }
        kept.push_back(std::move(sensor));
      }
    };
    std::visit(keep, model.sensors[i].kind);
  }
}

SceneSensing::SceneSensing(const Scene& scene) {
  std::map<const RobotModel*, std::uint32_t> indices;  // for look-up only; never iterated
  for (const SceneRobot& robot : scene.robots) {
    const RobotModel& model = *robot.entry.model;
    const auto [found, is_new] = indices.emplace(&model, static_cast<std::uint32_t>(types_.size()));
    if (is_new) types_.emplace_back(model);
    types_of_robots_.push_back(found->second);
    places_.push_back({kept_sensors_, ranges_});
    kept_sensors_ += static_cast<std::uint32_t>(types_[found->second].kept.size());
    ranges_ += types_[found->second].ranges;
  }
  double upright_radius_m = 0;
  for (const RobotType& type : types_) {
    max_hull_radius_m_ = std::max(max_hull_radius_m_, type.hull.whole_radius_m());
    upright_radius_m = std::max(upright_radius_m, type.hull.upright_radius_m());
  }
  for (RobotType& type : types_) {
    for (KeptSensor& sensor : type.kept) {
      if (const auto* distance = std::get_if<DistanceModel>(sensor.kind))
        sensor.fans = SensorFan::MakeAll(*distance, upright_radius_m);
    }
  }
  std::vector<RayItem> items;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (object.body >= 0) {
      movable_.push_back(static_cast<int>(i));
    } else {
      items.push_back(MakeRayItem(object.object.shape, object.object.X_WO));
    }
  }
  static_grid_.Build(items);
}

SceneSensing::~SceneSensing() = default;

std::unique_ptr<FrameBuffers> SceneSensing::TakeBuffers() const {
  {
    const MutexLock lock(mutex_);
    if (!free_.empty()) {
      std::unique_ptr<FrameBuffers> buffers = std::move(free_.back());
      free_.pop_back();
      return buffers;
    }
  }
  return std::make_unique<FrameBuffers>(*this);
}

void SceneSensing::GiveBuffers(std::unique_ptr<FrameBuffers> buffers) const {
  // The newest frame, the next one, and one or two held by readers.
  constexpr std::size_t kMostFree = 4;
  const MutexLock lock(mutex_);
  if (free_.size() < kMostFree) free_.push_back(std::move(buffers));
}

}  // namespace coopdyn
