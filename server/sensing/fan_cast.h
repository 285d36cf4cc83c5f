// SPDX-License-Identifier: MIT
// Casts one robot's fan of rays in one frame. Nearby robots and things are looked up once for all rays. In a
// swarm with short rays, most robots have nothing near and need no further work.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/geometry/ray_grid.h"
#include "server/sensing/robot_field.h"
#include "server/sensing/sensing_cache.h"
#include "server/sensing/sensor_fan.h"

namespace coopdyn {

class FanCast {
 public:
  /// All arguments must outlive the cast.
  FanCast(const SensingCache& cache, int robot, const SensorFan& fan)
      : cache_(cache),
        robot_(robot),
        fan_(fan),
        X_WR_(cache.field().pose(robot)),
        tilt_(X_WR_.q),
        has_map_(fan.HasMap(tilt_)) {}

  /// Casts all rays. Returns false if no ray hits anything.
  bool Run();
  /// After Run() has returned true: the distance at which ray `k` hits something within its range, including
  /// the floor; kNoHit if nothing.
  double distance_m(std::size_t k) const {
    return nearest_m_[k] < fan_.rays()[k].limit_m ? nearest_m_[k] : kNoHit;
  }
  /// Ray `k` of the fan in the world.
  Ray ray_W(std::size_t k);

 private:
  struct WorldRay {
    Vector3 origin, direction;  // uninitialised until needed
  };

  void Start();
  const WorldRay& GetRay(std::size_t k);
  /// The rays that may hit a thing inside a vertical cylinder whose axis is at (dx, dy) from R in the world.
  std::uint64_t RaysNear(double dx, double dy, double radius_m) const;
  void MeetFloor();
  void MeetFewRobots(std::span<const RobotField::Entry> entries);
  /// The same with a map. @pre has_map_ and Start() was called
  void MeetManyRobots(std::span<const RobotField::Entry> entries);
  void MeetRobot(const RobotField::Entry& entry, std::uint64_t rays);
  void MeetRobotsRayByRay();
  void MeetItems(const RayGrid& grid);

  const SensingCache& cache_;
  const int robot_;
  const SensorFan& fan_;
  const Pose& X_WR_;
  const Tilt tilt_;
  const bool has_map_;
  Extent reach_W_;  // contains all rays; upright about R's origin

  // Set by Start(), once something is near.
  bool started_ = false;
  Matrix3 R_WR_;
  SensorFan::Turn turn_;
  std::uint64_t made_ = 0;  // bit k: rays_W_[k] is set
  std::array<WorldRay, SensorFan::kMaxRays> rays_W_;
  std::array<double, SensorFan::kMaxRays> nearest_m_;  // limit_m of the ray: no hit yet
};

}  // namespace coopdyn
