// SPDX-License-Identifier: MIT
#include "server/physics/things.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

const char* WordFor(const Shape& shape) {
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
  Builder(const Scene& scene, const Things* before) : scene_(scene), before_(before) {}

  Things Build() {
    for (const SceneObject& object : scene_.objects) {
      if (object.body >= 0) AddObject(object.object);
    }
    things_.first_robot = things_.owners.size();
    for (std::size_t i = 0; i < scene_.robots.size(); ++i) AddRobot(static_cast<int>(i));
    things_.first_static = things_.owners.size();
    last_object_ = nullptr;
    for (const SceneObject& object : scene_.objects) {
      if (object.body < 0) AddObject(object.object);
    }
    return std::move(things_);
  }

 private:
  /// Objects that are alike share their mechanism; most stand one after another.
  const Mechanism* ObjectOf(const WorldObject& object) {
    const bool alike = last_object_ != nullptr && last_object_->shape == object.shape &&
                       last_object_->friction == object.friction && last_object_->mass_kg == object.mass_kg;
    if (!alike) things_.mechanisms.push_back(std::make_shared<const Mechanism>(MakeObject(object)));
    last_object_ = &object;
    return things_.mechanisms.back().get();
  }

  void AddObject(const WorldObject& object) {
    Owner owner{WordFor(object.shape), object.name, object.where};
    owner.mechanism = ObjectOf(object);
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
    const Kind& kind = KindOf(*entry.model, entry.fidelity);
    owner.mechanism = kind.mechanism;
    owner.pool = kind.pool;
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

  /// What robots of one type and fidelity share. More than one body need a pool of their own in ODE.
  struct Kind {
    const Mechanism* mechanism = nullptr;
    std::size_t pool = 0;
  };
  const Kind& KindOf(const RobotModel& model, Fidelity fidelity) {
    const auto is_it = [&](const auto& made) { return made->model == &model && made->fidelity == fidelity; };
    const auto known = std::ranges::find_if(kinds_, is_it, &Kind::mechanism);
    if (known != kinds_.end()) return *known;
    const double gravity_m_s2 = scene_.scenario->simulation.gravity_m_s2;
    std::shared_ptr<const Mechanism> mechanism;
    if (before_ != nullptr) {
      const auto made = std::ranges::find_if(before_->mechanisms, is_it);
      if (made != before_->mechanisms.end()) mechanism = *made;
    }
    if (mechanism == nullptr) {
      mechanism =
          std::make_shared<const Mechanism>(MakeRobot(model, fidelity, scene_.floor.friction, gravity_m_s2));
    }
    Kind kind{mechanism.get()};
    if (!kind.mechanism->hinges.empty() || kind.mechanism->bodies.size() > 1) {
      kind.pool = things_.pools.size();
      things_.pools.push_back(kind.mechanism);
    }
    things_.mechanisms.push_back(std::move(mechanism));
    return kinds_.emplace_back(kind);
  }

  const Scene& scene_;
  const Things* const before_;
  Things things_;
  const WorldObject* last_object_ = nullptr;
  std::vector<Kind> kinds_;
};

}  // namespace

Things MakeThings(const Scene& scene, const Things* before) {
  return Builder(scene, before).Build();
}

}  // namespace coopdyn
