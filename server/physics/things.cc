// SPDX-License-Identifier: MIT
#include "server/physics/things.h"

#include <utility>

namespace coopdyn {

namespace {

const char* KindOf(const Shape& shape) {
  constexpr const char* kKinds[] = {"box", "cylinder", "sphere"};
  return kKinds[shape.index()];
}

BodyState StateAt(const Pose& X_WB) {
  BodyState state;
  state.p_WB = X_WB.p;
  const Quaternion q = X_WB.q.normalized();
  state.q_WB = {q.w(), q.x(), q.y(), q.z()};
  const Matrix3 R = q.toRotationMatrix();
  for (std::size_t i = 0; i < 9; ++i) {
    state.R_WB[i] = R(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  }
  return state;
}

class Builder {
 public:
  explicit Builder(const Scene& scene) : scene_(scene) {}

  Things Build() {
    for (const SceneObject& object : scene_.objects) {
      if (object.body >= 0) AddObject(object.object);
    }
    things_.first_robot = things_.owners.size();
    for (std::size_t i = 0; i < scene_.robots.size(); ++i) AddRobot(static_cast<int>(i));
    things_.first_static = things_.owners.size();
    for (const SceneObject& object : scene_.objects) {
      if (object.body < 0) AddObject(object.object);
    }
    return std::move(things_);
  }

 private:
  const Mechanism* Keep(Mechanism mechanism) {
    if (!mechanism.hinges.empty() || mechanism.bodies.size() > 1) mechanism.pool = things_.pools.size();
    things_.mechanisms.push_back(std::make_unique<Mechanism>(std::move(mechanism)));
    const Mechanism* kept = things_.mechanisms.back().get();
    if (kept->pool > 0) things_.pools.push_back(kept);
    return kept;
  }

  void AddObject(const WorldObject& object) {
    Owner owner{KindOf(object.shape), object.name, object.where};
    owner.mechanism = Keep(MakeObject(object));
    owner.first_body = static_cast<int>(things_.start.size());
    if (object.is_static()) {
      owner.fixed = StateAt(object.X_WO);
    } else {
      things_.start.push_back(StateAt(object.X_WO));
    }
    things_.owners.push_back(std::move(owner));
  }

  void AddRobot(int index) {
    const SceneRobot& robot = scene_.robots[static_cast<std::size_t>(index)];
    const RobotEntry& entry = robot.entry;
    Owner owner{"robot", entry.name, entry.where};
    owner.robot = index;
    owner.mechanism = RobotOf(*entry.model, entry.fidelity);
    owner.first_body = static_cast<int>(things_.start.size());
    owner.p_BR = robot.X_BR.p;
    owner.up_B = robot.X_BR.q * Vector3::UnitZ();
    owner.first_channel = static_cast<std::size_t>(robot.first_channel);
    owner.channel_count = static_cast<std::size_t>(robot.channel_count);
    if (robot.one_body()) {
      const bool planar = entry.fidelity == Fidelity::kPlanar;
      owner.rest_z_m = owner.mechanism->bodies.front().X_RB.p.z() + (planar ? entry.X_WR.p.z() : 0);
    }
    for (const RigidBody& body : owner.mechanism->bodies) {
      things_.start.push_back(StateAt(entry.X_WR * body.X_RB));
    }
    things_.owners.push_back(std::move(owner));
  }

  /// Robots of one type and fidelity share their mechanism.
  const Mechanism* RobotOf(const RobotModel& model, Fidelity fidelity) {
    for (const Mechanism* made : robots_) {
      if (made->model == &model && made->fidelity == fidelity) return made;
    }
    robots_.push_back(
        Keep(MakeRobot(model, fidelity, scene_.floor.friction, scene_.scenario->simulation.gravity_m_s2)));
    return robots_.back();
  }

  const Scene& scene_;
  Things things_;
  std::vector<const Mechanism*> robots_;
};

}  // namespace

Things MakeThings(const Scene& scene) {
  return Builder(scene).Build();
}

}  // namespace coopdyn
