// SPDX-License-Identifier: MIT
#include "server/sensing/pick.h"

namespace coopdyn {

namespace {

double Distance(const Ray& ray_W, const Shape& shape, const Pose& X_WG) {
  const Quaternion q = X_WG.q.conjugate();
  return RayToShape({q * (ray_W.origin - X_WG.p), q * ray_W.direction}, shape);
}

}  // namespace

Picked Pick(const Frame& frame, const Ray& ray_W) {
  const Scene& scene = *frame.scene;
  Picked picked;
  const double floor_m = RayToFloor(ray_W);
  if (floor_m < kNoHit) {
    const Vector3 p_W = ray_W.origin + floor_m * ray_W.direction;
    if (scene.floor.IsUnder(p_W.x(), p_W.y())) picked.distance_m = floor_m;
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& thing = scene.objects[i];
    const double distance_m = Distance(ray_W, thing.object.shape, ObjectPose(frame, thing));
    if (distance_m < picked.distance_m) picked = {static_cast<int>(i), -1, distance_m};
  }
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const RobotModel& model = *scene.robots[i].entry.model;
    for (std::size_t link = 0; link < model.links.size(); ++link) {
      if (model.links[link].collisions.empty()) continue;
      const Pose X_WL = LinkPose(frame, static_cast<int>(i), static_cast<int>(link));
      for (const LinkShape& shape : model.links[link].collisions) {
        const double distance_m = Distance(ray_W, shape.shape, X_WL * shape.X_LG);
        if (distance_m < picked.distance_m) picked = {-1, static_cast<int>(i), distance_m};
      }
    }
  }
  return picked;
}

}  // namespace coopdyn
