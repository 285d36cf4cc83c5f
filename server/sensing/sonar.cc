// SPDX-License-Identifier: MIT
// Sonars: the nearest point in a cone, or on rays within it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "server/base/portable_math.h"
#include "server/geometry/cone.h"
#include "server/sensing/range_noise.h"
#include "server/sensing/ray_caster.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

namespace {

/// Finds the nearest thing in a cone.
class ConeSearch {
 public:
  ConeSearch(const SensingCache& cache, int robot, const SonarModel::Beam& beam)
      : cache_(cache), nearest_m_(beam.max_range_m) {
    const Pose X_WS = MountPose(cache.frame(), robot, beam.mount);
    cone_W_ = {X_WS.p, X_WS.q * Vector3::UnitX(), beam.opening_rad / 2};
    MeetFloor();
    MeetItems(cache.scene().static_grid());
    if (!cache.scene().movable().empty()) MeetItems(cache.movable_grid());
    MeetRobots(robot, beam.mount.link);
  }
  /// kNoHit: nothing in range.
  double range_m() const { return found_ ? nearest_m_ : kNoHit; }

 private:
  void Found(double range_m) {
    if (range_m > nearest_m_) return;
    nearest_m_ = range_m;
    found_ = true;
  }
  void MeetFloor() {
    const double down_rad = portable::Acos(std::clamp(-cone_W_.axis.z(), -1.0, 1.0));
    if (down_rad <= cone_W_.half_angle_rad) Found(std::max(0.0, cone_W_.apex.z()));
  }
  void MeetShape(const Shape& shape, const Pose& X_WG) {
    if (!ConeMeetsSphere(cone_W_, X_WG.p, BoundingRadius(shape))) return;
    const Pose X_GW = X_WG.Inverse();
    const Cone cone_G{X_GW * cone_W_.apex, X_GW.q * cone_W_.axis, cone_W_.half_angle_rad};
    Found(NearestInCone(cone_G, shape, nearest_m_));
  }
  void MeetItems(const RayGrid& grid) {
    const double x = cone_W_.apex.x(), y = cone_W_.apex.y();
    for (const std::uint32_t index :
         grid.AllNear({x - nearest_m_, y - nearest_m_, x + nearest_m_, y + nearest_m_})) {
      const RayItem& item = grid.items()[index];
      MeetShape(item.shape, {item.p_WG, Quaternion(item.R_WG)});
    }
  }
  void MeetRobots(int robot, int link) {
    const RobotField& field = cache_.field();
    field.ForHulls(cone_W_.apex.x(), cone_W_.apex.y(), nearest_m_, [&](auto entries) {
      for (const RobotField::Entry& entry : entries)
        MeetRobot(entry, entry.robot == robot ? link : RobotHull::kNoLink);
    });
  }
  void MeetRobot(const RobotField::Entry& entry, int ignored_link) {
    const Vector3 middle(entry.x, entry.y, (entry.min_z + entry.max_z) / 2);
    if (!ConeMeetsSphere(cone_W_, middle, portable::Hypot(entry.radius_m, (entry.max_z - entry.min_z) / 2)))
      return;
    cache_.scene()
        .type(entry.robot)
        .hull.ForShapes(cache_.frame(), entry.robot, cache_.field().pose(entry.robot), ignored_link,
                        [this](const Shape& shape, const Pose& X_WG) { MeetShape(shape, X_WG); });
  }

  const SensingCache& cache_;
  Cone cone_W_;
  double nearest_m_;
  bool found_ = false;
};

double NearestOnRays(const SensingCache& cache, int robot, const SonarModel::Beam& beam) {
  const Pose X_WS = MountPose(cache.frame(), robot, beam.mount);
  const RayCaster caster(cache, robot, beam.mount.link);
  double nearest_m = kNoHit;
  for (int i = 0; i < beam.rays; ++i) {
    const Ray ray_W{X_WS.p, X_WS.q * beam.Direction(i)};
    nearest_m = std::min(nearest_m, caster.Cast(ray_W, std::min(nearest_m, beam.max_range_m)));
  }
  return nearest_m;
}

}  // namespace

void Compute(const SonarModel& model, const KeptSensor& sensor, const SensingCache& cache, int robot,
             std::span<double> ranges_m) {
  NoiseKey key = KeyOf(cache.frame(), robot, NoiseKind::kSonar, sensor.number);
  for (std::size_t k = 0; k < ranges_m.size(); ++k) {
    const SonarModel::Beam& beam = model.beams[k];
    key.sample = static_cast<std::uint32_t>(k);
    const double range_m =
        beam.rays > 0 ? NearestOnRays(cache, robot, beam) : ConeSearch(cache, robot, beam).range_m();
    ranges_m[k] = NoisyRange(range_m, beam.min_range_m, beam.max_range_m, beam.noise, key);
  }
}

std::span<const double> SonarRanges(const Frame& frame, int robot, std::size_t number) {
  return SensingCache::Of(frame).ValuesOf<SonarModel>(robot, number);
}

std::vector<RangeCone> SonarCones(const Frame& frame, int robot, std::size_t number) {
  const auto* const model = ModelOf(frame, robot).Find<SonarModel>(number);
  if (model == nullptr) return {};
  const std::span<const double> ranges_m = SonarRanges(frame, robot, number);
  std::vector<RangeCone> cones;
  for (std::size_t k = 0; k < ranges_m.size(); ++k) {
    const SonarModel::Beam& beam = model->beams[k];
    if (beam.rays > 0) continue;
    const bool far = ranges_m[k] == kNoHit;
    cones.push_back({MountPose(frame, robot, beam.mount), beam.opening_rad / 2,
                     far ? beam.max_range_m : ranges_m[k], !far});
  }
  return cones;
}

std::vector<RaySegment> SonarRays(const Frame& frame, int robot, std::size_t number) {
  const auto* const model = ModelOf(frame, robot).Find<SonarModel>(number);
  if (model == nullptr) return {};
  std::vector<RaySegment> segments;
  for (const SonarModel::Beam& beam : model->beams) {
    const Pose X_WS = MountPose(frame, robot, beam.mount);
    const RayCaster caster(SensingCache::Of(frame), robot, beam.mount.link);
    for (int i = 0; i < beam.rays; ++i)
      segments.push_back(caster.Segment({X_WS.p, X_WS.q * beam.Direction(i)}, beam.max_range_m));
  }
  return segments;
}

}  // namespace coopdyn
