// SPDX-License-Identifier: MIT
#include "server/physics/things.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

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

}  // namespace

void Orient(BodyState& body, const Quaternion& q) {
  body.q_WB = {q.w(), q.x(), q.y(), q.z()};
  const Matrix3 R = q.toRotationMatrix();
  for (int i = 0; i < 9; ++i) body.R_WB[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
}

std::vector<BodyState> StartBodies(const Mechanism& mechanism, const Pose& X_WR) {
  std::vector<BodyState> bodies;
  for (const RigidBody& body : mechanism.bodies) bodies.push_back(StateAt(X_WR * body.X_RB));
  return bodies;
}

std::vector<BodyState> StartBodies(const Mechanism& mechanism, const WorldObject& object) {
  std::vector<BodyState> bodies = StartBodies(mechanism, object.X_WO);
  for (BodyState& body : bodies) {
    body.v_WB = object.v_WO;
    body.w_WB = object.w_WO;
  }
  return bodies;
}

namespace {

class Builder {
 public:
  Builder(const Scene& scene, const Things* before) : scene_(scene), before_(before) {}

  Things Build() {
    things_.all.reserve(scene_.objects.size() + scene_.robots.size());
    AddObjects(false);
    things_.first_robot = things_.all.size();
    for (std::size_t i = 0; i < scene_.robots.size(); ++i) AddRobot(static_cast<int>(i));
    things_.first_static = things_.all.size();
    last_object_ = nullptr;
    AddObjects(true);
    return std::move(things_);
  }

 private:
  /// Identical objects share their mechanism; most are listed consecutively.
  const Mechanism* ObjectOf(const WorldObject& object) {
    const bool alike = last_object_ != nullptr && last_object_->IsAlike(object);
    if (!alike) things_.mechanisms.push_back(std::make_shared<const Mechanism>(MakeObject(object)));
    last_object_ = &object;
    return things_.mechanisms.back().get();
  }

  void AddObjects(bool is_static) {
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      const WorldObject& object = scene_.objects[i].object;
      if ((scene_.objects[i].body < 0) != is_static) continue;
      Thing thing;
      thing.object = static_cast<int>(i);
      thing.mechanism = ObjectOf(object);
      thing.first_body = bodies_;
      if (is_static) {
        thing.fixed = StateAt(object.X_WO);
      } else {
        AddBodies(StartBodies(*thing.mechanism, object));
      }
      things_.all.push_back(thing);
    }
  }

  void AddBodies(const std::vector<BodyState>& bodies) {
    bodies_ += static_cast<int>(bodies.size());
    if (before_ == nullptr) things_.bodies.insert(things_.bodies.end(), bodies.begin(), bodies.end());
  }

  void AddRobot(int index) {
    const SceneRobot& robot = scene_.robots[static_cast<std::size_t>(index)];
    const RobotEntry& entry = robot.entry;
    Thing thing;
    thing.robot = index;
    const Kind& kind = KindOf(*entry.model, entry.fidelity);
    thing.mechanism = kind.mechanism;
    thing.pool = kind.pool;
    thing.first_body = bodies_;
    thing.p_BR = robot.X_BR.p;
    thing.up_B = robot.X_BR.q * Vector3::UnitZ();
    thing.first_channel = static_cast<std::size_t>(robot.first_channel);
    thing.channel_count = static_cast<std::size_t>(robot.channel_count);
    thing.first_control = static_cast<std::size_t>(robot.first_control);
    thing.control_count = static_cast<std::size_t>(robot.control_count);
    if (robot.one_body()) {
      const bool planar = entry.fidelity == Fidelity::kPlanar;
      thing.rest_z_m = thing.mechanism->bodies.front().X_RB.p.z() + (planar ? entry.X_WR.p.z() : 0);
    }
    AddBodies(StartBodies(*thing.mechanism, entry.X_WR));
    things_.all.push_back(thing);
  }

  /// Shared by robots of one type and fidelity. A kind with several bodies or a fixed base has its own pool
  /// in ODE.
  struct Kind {
    const Mechanism* mechanism = nullptr;
    std::size_t pool = 0;
  };
  const Kind& KindOf(const RobotModel& model, Fidelity fidelity) {
    const auto is_it = [&](const auto& made) { return made->model == &model && made->fidelity == fidelity; };
    const auto known = std::ranges::find_if(kinds_, is_it, &Kind::mechanism);
    if (known != kinds_.end()) return *known;
    std::shared_ptr<const Mechanism> mechanism;
    if (before_ != nullptr) {
      const auto made = std::ranges::find_if(before_->mechanisms, is_it);
      if (made != before_->mechanisms.end()) mechanism = *made;
    }
    if (mechanism == nullptr) {
      mechanism = std::make_shared<const Mechanism>(
          MakeRobot(model, fidelity, scene_.floor.friction, scene_.scenario->simulation.g_W));
    }
    Kind kind{mechanism.get()};
    if (kind.mechanism->fixed_base || kind.mechanism->bodies.size() > 1) {
      kind.pool = things_.pools.size();
      things_.pools.push_back(kind.mechanism);
    }
    things_.mechanisms.push_back(std::move(mechanism));
    return kinds_.emplace_back(kind);
  }

  const Scene& scene_;
  const Things* const before_;
  Things things_;
  int bodies_ = 0;
  const WorldObject* last_object_ = nullptr;
  std::vector<Kind> kinds_;
};

}  // namespace

Things MakeThings(const Scene& scene) {
  return Builder(scene, nullptr).Build();
}

Things MakeThings(const Scene& scene, const Things& before) {
  return Builder(scene, &before).Build();
}

std::string TitleOf(const Scene& scene, const Thing& thing) {
  constexpr const char* kShapes[] = {"box", "cylinder", "sphere", "capsule", "mesh"};
  if (thing.robot >= 0) return "robot " + NameOf(scene, thing);
  const Shape& shape = scene.objects[static_cast<std::size_t>(thing.object)].object.shape;
  return std::string(kShapes[shape.index()]) + " " + NameOf(scene, thing);
}

const std::string& NameOf(const Scene& scene, const Thing& thing) {
  if (thing.robot >= 0) return scene.robots[static_cast<std::size_t>(thing.robot)].entry.name;
  return scene.objects[static_cast<std::size_t>(thing.object)].object.name;
}

const SourceLine& WhereOf(const Scene& scene, const Thing& thing) {
  if (thing.robot >= 0) return scene.robots[static_cast<std::size_t>(thing.robot)].entry.where;
  return scene.objects[static_cast<std::size_t>(thing.object)].object.where;
}

}  // namespace coopdyn
