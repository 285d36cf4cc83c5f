// SPDX-License-Identifier: MIT
#include "server/state/world_moves.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

template <typename Things>
int PlaceOf(const Things& things, std::uint32_t id) {
  const auto found = std::ranges::find(things, id, [](const auto& thing) { return thing.id.value; });
  return found == things.end() ? -1 : static_cast<int>(found - things.begin());
}

/// True if both poses are equal up to rounding.
bool IsThere(const Pose& a, const Pose& b) {
  constexpr double kTiny = 1e-12, kTiny_rad = 1e-9;
  return (a.p - b.p).cwiseAbs().maxCoeff() < kTiny && (a.q.conjugate() * b.q).vec().norm() < kTiny_rad / 2;
}

// Residual motion of a body at rest.
constexpr double kRest_m_s = 2e-3, kRest_rad_s = 1e-2;

Vector3 WithoutTrembling(const Vector3& motion, double rest) {
  return motion.norm() > rest ? motion : Vector3(Vector3::Zero());
}

}  // namespace

Found FindId(const Scene& scene, std::int32_t id) {
  const auto value = static_cast<std::uint32_t>(id % WorldId::kRobots);
  Found found;
  if (id <= 0) return found;
  switch (id / WorldId::kRobots) {
    case 0:
      found.object = PlaceOf(scene.objects, value);
      break;
    case 1:
      found.robot = PlaceOf(scene.robots, value);
      break;
    case 2:
      found.target = PlaceOf(scene.targets, value);
      break;
    case 3:
      if (value >= 1 && value <= scene.lights.size()) found.light = static_cast<int>(value) - 1;
      break;
    default:
      break;
  }
  return found;
}

WorldObject ObjectNow(const Frame& frame, const SceneObject& thing) {
  WorldObject object = thing.object;
  const Pose now = ObjectPose(frame, thing);
  if (!IsThere(now, object.X_WO)) object.X_WO = {now.p, now.q.normalized()};
  if (thing.body < 0) return object;
  const BodyState& body = frame.bodies[static_cast<std::size_t>(thing.body)];
  object.v_WO = WithoutTrembling(body.v_WB, kRest_m_s);
  object.w_WO = WithoutTrembling(body.w_WB, kRest_rad_s);
  return object;
}

RobotEntry RobotNow(const Frame& frame, int place) {
  RobotEntry entry = RobotAt(*frame.scene, place).entry;
  const Pose now = RobotPose(frame, place);
  if (!IsThere(now, entry.X_WR)) entry.X_WR = {now.p, now.q.normalized()};
  // A standing robot sinks in slightly; a place below the floor is not valid.
  constexpr double kSunk_m = 5e-3;
  if (entry.X_WR.p.z() < 0 && entry.X_WR.p.z() > -kSunk_m) entry.X_WR.p.z() = 0;
  return entry;
}

std::string AddMove(const Frame& frame, const Found& found, const Pose& X_W, WorldChange& change) {
  const Scene& scene = *frame.scene;
  if (found.object >= 0) {
    const SceneObject& thing = ObjectAt(scene, found.object);
    change.objects.push_back({thing.id, thing.object, Placing::kStart});
    change.objects.back().object.X_WO = X_W;
    change.objects.back().object.v_WO.setZero();
    change.objects.back().object.w_WO.setZero();
    return thing.object.name;
  }
  if (found.robot >= 0) {
    const SceneRobot& robot = RobotAt(scene, found.robot);
    change.robots.push_back({robot.id, robot.entry, Placing::kStart});
    change.robots.back().entry.X_WR = X_W;
    return robot.entry.name;
  }
  if (found.target >= 0) {
    change.targets.push_back(scene.targets[static_cast<std::size_t>(found.target)]);
    change.targets.back().p_WT = X_W.p;
    return TargetName(change.targets.back());
  }
  if (!change.lights) change.lights = scene.lights;
  PointLight& light = (*change.lights)[static_cast<std::size_t>(found.light)];
  light.p_WP = X_W.p;
  return light.name;
}

}  // namespace coopdyn
