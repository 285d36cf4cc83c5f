// SPDX-License-Identifier: MIT
// Data that sensing derives from one frame: the field of robots on first use of anything, the grid of movable
// objects and each kept sensor's values on their first use. Lives in Frame::cache. Any thread: the first user
// of a part computes it; other threads wait only for that part.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "server/geometry/ray_grid.h"
#include "server/sensing/robot_field.h"
#include "server/sensing/scene_sensing.h"
#include "server/state/frame.h"

namespace coopdyn {

class SensingCache;

// A kind of sensor whose values are kept has two functions: ValueCount() and Compute(). All other kinds are
// computed on each reading.
inline std::size_t ValueCount(const DistanceModel& model) {
  return model.sectors.size();
}
inline std::size_t ValueCount(const LidarModel& model) {
  return model.rays();
}
inline std::size_t ValueCount(const SonarModel& model) {
  return model.beams.size();
}
inline std::size_t ValueCount(const InfraredModel& model) {
  return model.eyes.size();
}
void Compute(const DistanceModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> ranges_m);
void Compute(const LidarModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> ranges_m);
void Compute(const SonarModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> ranges_m);
void Compute(const InfraredModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> values);
template <typename Kind>
concept IsKept = requires(const Kind& kind) { ValueCount(kind); };

RayItem MakeRayItem(const Shape& shape, const Pose& X_WG);

/// The memory of a cache, reused by later frames of the scene.
struct FrameBuffers {
  explicit FrameBuffers(const SceneSensing& scene);

  RobotField field;
  std::vector<RayItem> movable_items;
  RayGrid movable_grid;
  std::unique_ptr<std::atomic<std::uint8_t>[]> progress;  // per kept sensor
  // A sensor's values are guarded by its progress.
  std::vector<double> ranges;              // of distance sensors
  std::vector<std::vector<double>> lists;  // per kept sensor; empty until read
};

class SensingCache final : public FrameCache {
 public:
  /// The cache of `frame`, created on the first call, using `pool`'s threads unless it is null.
  static const SensingCache& Of(const Frame& frame, WorkerPool* pool = nullptr);

  SensingCache(const Frame& frame, WorkerPool* pool);
  ~SensingCache() override;
  SensingCache(const SensingCache&) = delete;
  SensingCache& operator=(const SensingCache&) = delete;

  const Frame& frame() const { return frame_; }
  const SceneSensing& scene() const { return scene_; }
  const RobotField& field() const { return buffers_->field; }
  const RayGrid& movable_grid() const;

  /// The values of kept sensor `kept` (index into RobotType::kept) of `robot`; empty if there is none.
  std::span<const double> Values(int robot, std::size_t kept) const;
  /// The values of sensor `number` of a kind.
  template <typename Kind>
  std::span<const double> ValuesOf(int robot, std::size_t number) const {
    return Values(robot, scene_.type(robot).IndexOf<Kind>(number));
  }
  /// The values of all distance sensors of `robot`.
  std::span<const double> Distances(int robot) const;

  /// The nearest hit of `ray_W` within `max_range_m` (finite), ignoring the floor and `ignored_robot`.
  ThingHit Cast(const Ray& ray_W, double max_range_m, int ignored_robot) const;

 private:
  /// Computes the values of a kept sensor unless available. One thread computes; other threads wait.
  void Need(int robot, const SceneSensing::Place& place, std::size_t kept) const;
  void Make(int robot, const SceneSensing::Place& place, std::size_t kept) const;
  /// The memory of the values.
  std::span<double> PlaceOf(int robot, const SceneSensing::Place& place, std::size_t kept) const;

  const Frame& frame_;
  const SceneSensing& scene_;
  std::unique_ptr<FrameBuffers> buffers_;
  mutable std::once_flag movable_once_;
};

}  // namespace coopdyn
