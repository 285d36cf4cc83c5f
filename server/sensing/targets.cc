// SPDX-License-Identifier: MIT
// The target module: landmarks and other robots, seen by a camera above the axle at the robot's full height.
#include <cmath>

#include "server/sensing/lookout.h"

namespace coopdyn {

namespace {

using Eye = Lookout<TargetModel>;

bool IsHidden(const Eye& eye, const Vector3& p_W, int robot) {
  const Vector3 eye_W = eye.X_WR() * Vector3(0, 0, eye.self().entry.model->height_m);
  const Vector3 way = p_W - eye_W;
  const double length_m = way.norm();
  if (length_m <= 0) return false;
  const ThingHit hit = eye.cache().Cast({eye_W, way / length_m}, length_m, eye.robot());
  // What lies behind the surface that was hit can only be the thing itself.
  return hit && (robot < 0 || hit.robot != robot);
}

/// Appends the sighting of the thing `index` at `p_W` if it is in range and in view. `robot`: the robot that
/// it is, -1 if none.
void Look(const Eye& eye, int index, std::uint32_t id, const Vector3& p_W, int robot, const SightNoise& noise,
          std::vector<Sighting>& seen) {
  const double distance_m = std::hypot(p_W.x() - eye.X_WR().p.x(), p_W.y() - eye.X_WR().p.y());
  const double most_m = eye.model().max_range_m;
  if (distance_m > most_m) return;
  if (!eye.model().see_through && IsHidden(eye, p_W, robot)) return;
  seen.push_back(eye.See(index, id, p_W, distance_m, most_m, noise));
}

}  // namespace

std::vector<Sighting> SeenTargets(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<TargetModel>(number);
  if (model == nullptr) return {};
  const Eye eye(frame, robot, number, *model);
  std::vector<Sighting> seen;
  const std::vector<Target>& targets = frame.scene->targets;
  seen.reserve(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    Look(eye, static_cast<int>(i), targets[i].id.value, targets[i].p_WT, -1,
         {NoiseKind::kTargetDistance, NoiseKind::kTargetBearing}, seen);
  }
  return seen;
}

std::vector<Sighting> SeenRobots(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<TargetModel>(number);
  if (model == nullptr) return {};
  const Eye eye(frame, robot, number, *model);
  std::vector<Sighting> seen;
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  for (int other = 0; other < static_cast<int>(robots.size()); ++other) {
    if (other == robot) continue;
    const SceneRobot& scene_robot = robots[static_cast<std::size_t>(other)];
    // The middle of its body; in the plane that is its axle's middle unless it leans.
    Vector3 p_W = eye.field().pose(other).p;
    p_W.z() += scene_robot.entry.model->height_m / 2;
    Look(eye, other, scene_robot.id.value, p_W, other, {NoiseKind::kRobotDistance, NoiseKind::kRobotBearing},
         seen);
  }
  return seen;
}

}  // namespace coopdyn
