// SPDX-License-Identifier: MIT
// One robot looking around: what the sensors of targets, robots and neighbours share. Pure; any thread.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "server/sensing/noise.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

/// How the noise of one kind of sighting is keyed.
struct SightNoise {
  NoiseKind distance, bearing;
};

/// `Kind`: the sensor's model, TargetModel or NeighboursModel.
template <typename Kind>
class Lookout {
 public:
  /// Sensor `number` of its kind of robot `robot`. The frame and the model outlive it.
  Lookout(const Frame& frame, int robot, std::size_t number, const Kind& model)
      : frame_(frame),
        cache_(SensingCache::Of(frame)),
        robot_(robot),
        number_(static_cast<std::uint32_t>(number)),
        model_(model),
        self_(frame.scene->robots[static_cast<std::size_t>(robot)]),
        X_WR_(cache_.field().pose(robot)),
        heading_rad_(Heading(X_WR_.q)) {}

  const SensingCache& cache() const { return cache_; }
  const RobotField& field() const { return cache_.field(); }
  int robot() const { return robot_; }
  const SceneRobot& self() const { return self_; }
  const Kind& model() const { return model_; }
  const Pose& X_WR() const { return X_WR_; }

  /// The thing `index` at `p_W`, `distance_m` away, as read with noise; at most `most_m` away. `id`: its own.
  Sighting See(int index, std::uint32_t id, const Vector3& p_W, double distance_m, double most_m,
               const SightNoise& noise) const {
    Sighting sighting{index, distance_m, 0};
    if (distance_m > 0) {
      sighting.bearing_rad =
          WrapAngle(std::atan2(p_W.y() - X_WR_.p.y(), p_W.x() - X_WR_.p.x()) - heading_rad_);
    }
    if (model_.distance_noise_stddev_m > 0) {
      const double noise_m = model_.distance_noise_stddev_m * GaussianNoise(Key(noise.distance, id));
      sighting.distance_m = std::clamp(sighting.distance_m + noise_m, 0.0, most_m);
    }
    if (model_.bearing_noise_stddev_rad > 0) {
      const double noise_rad = model_.bearing_noise_stddev_rad * GaussianNoise(Key(noise.bearing, id));
      sighting.bearing_rad = WrapAngle(sighting.bearing_rad + noise_rad);
    }
    return sighting;
  }

  NoiseKey Key(NoiseKind kind, std::uint32_t id) const {
    return {frame_.seed, kind, self_.id.value, id, frame_.step, number_};
  }

 private:
  const Frame& frame_;
  const SensingCache& cache_;
  const int robot_;
  const std::uint32_t number_;
  const Kind& model_;
  const SceneRobot& self_;
  const Pose& X_WR_;
  const double heading_rad_;
};

}  // namespace coopdyn
