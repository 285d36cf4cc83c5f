// SPDX-License-Identifier: MIT
#include "server/sensing/readings.h"

#include <algorithm>
#include <cmath>

#include "server/sensing/distance_rays.h"
#include "server/sensing/noise.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

namespace {

// The vision of one robot: a camera above its axle at its full height.
class Eye {
 public:
  Eye(const Frame& frame, int robot)
      : frame_(frame),
        cache_(SensingCache::Of(frame)),
        robot_(robot),
        self_(frame.scene->robots[static_cast<std::size_t>(robot)]),
        sensor_(self_.entry.model->target_sensor),
        X_WR_(cache_.robot_pose(robot)),
        heading_rad_(Heading(X_WR_.q)) {}

  /// Appends the sighting of the thing `index` at `p_W` if it is in range and in view. `owner`: whose shapes
  /// do not hide it. Noise is keyed by `id`.
  void Look(int index, std::uint32_t id, const Vector3& p_W, std::uint32_t owner, NoiseKind distance_kind,
            NoiseKind bearing_kind, std::vector<Sighting>& seen) const {
    const double dx = p_W.x() - X_WR_.p.x();
    const double dy = p_W.y() - X_WR_.p.y();
    Sighting sighting{index, std::hypot(dx, dy), 0};
    if (sighting.distance_m > sensor_.max_range_m) return;
    if (!sensor_.see_through && IsHidden(p_W, owner)) return;
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
  bool IsHidden(const Vector3& p_W, std::uint32_t owner) const {
    const Vector3 eye_W = X_WR_ * Vector3(0, 0, self_.entry.model->height_m);
    const Vector3 way = p_W - eye_W;
    const double length_m = way.norm();
    if (length_m <= 0) return false;
    const RayHit hit = cache_.grid().Cast({eye_W, way / length_m}, length_m, SensingCache::OwnerOf(robot_));
    // What lies behind the surface that was hit can only be the thing itself.
    return hit && (owner == SensingCache::kNobody || hit.owner != owner);
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
    eye.Look(static_cast<int>(i), targets[i].id.value, targets[i].p_WT, SensingCache::kNobody,
             NoiseKind::kTargetDistance, NoiseKind::kTargetBearing, seen);
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
    Vector3 p_W = cache.robot_pose(other).p;
    p_W.z() += scene_robot.entry.model->height_m / 2;
    eye.Look(other, scene_robot.id.value, p_W, SensingCache::OwnerOf(other), NoiseKind::kRobotDistance,
             NoiseKind::kRobotBearing, seen);
  }
  return seen;
}

std::vector<RaySegment> DistanceRays(const Frame& frame, int robot) {
  const SensingCache& cache = SensingCache::Of(frame);
  std::vector<RaySegment> segments;
  const RobotModel& model = *frame.scene->robots[static_cast<std::size_t>(robot)].entry.model;
  for (const DistanceSensorModel& sensor : model.distance_sensors) {
    const Pose X_WS = cache.robot_pose(robot) * sensor.X_RS;
    for (int i = 0; i < sensor.rays; ++i) {
      const Ray ray = SensorRay(sensor, X_WS, i);
      const double range_m = CastSensorRay(cache.grid(), ray, sensor.max_range_m, robot);
      const bool hit = range_m < kNoHit;
      segments.push_back(
          {ray.origin, ray.origin + (hit ? range_m : sensor.max_range_m) * ray.direction, hit});
    }
  }
  return segments;
}

}  // namespace coopdyn
