// SPDX-License-Identifier: MIT
// What sensing derives from one frame: the field of robots at the first use of anything, the grid of movable
// objects and each kept sensor's values at their first use. Lives in Frame::cache. Any thread; whoever needs
// a part first makes it, others wait for that part only.
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

// The kinds of sensors whose values are kept have two functions each: ValueCount() and Compute(). All others
// are computed each time they are read.
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

/// The memory behind a cache, used again by later frames of the scene.
struct FrameBuffers {
  explicit FrameBuffers(const SceneSensing& scene);

  RobotField field;
  std::vector<RayItem> movable_items;
  RayGrid movable_grid;
  std::unique_ptr<std::atomic<std::uint8_t>[]> progress;  // of each kept sensor
  // A sensor's part is guarded by its progress.
  std::vector<double> ranges;              // of distance sensors
  std::vector<std::vector<double>> lists;  // of each kept sensor; empty until somebody reads it
};

class SensingCache final : public FrameCache {
 public:
  /// The cache of `frame`, made now if this is the first call; with `pool`'s help unless that is null.
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
  /// Those of sensor `number` of a kind.
  template <typename Kind>
  std::span<const double> ValuesOf(int robot, std::size_t number) const {
    return Values(robot, scene_.type(robot).IndexOf<Kind>(number));
  }
  /// Those of all its distance sensors.
  std::span<const double> Distances(int robot) const;

  /// The nearest thing at `max_range_m` (finite) or nearer on `ray_W`, the floor and `ignored_robot` left
  /// out.
  ThingHit Cast(const Ray& ray_W, double max_range_m, int ignored_robot) const;

 private:
  /// Computes the values of a kept sensor unless they are there. One thread computes, others wait for it.
  void Need(int robot, const SceneSensing::Place& place, std::size_t kept) const;
  void Make(int robot, const SceneSensing::Place& place, std::size_t kept) const;
  /// Where they are.
  std::span<double> PlaceOf(int robot, const SceneSensing::Place& place, std::size_t kept) const;

  const Frame& frame_;
  const SceneSensing& scene_;
  std::unique_ptr<FrameBuffers> buffers_;
  mutable std::once_flag movable_once_;
};

}  // namespace coopdyn
