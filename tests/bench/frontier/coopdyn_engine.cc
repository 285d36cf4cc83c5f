// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/bench/frontier/engine.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn::frontier {
namespace {

LinkModel LinkOf(const Body& body, int index) {
  LinkModel link;
  link.name = "link" + std::to_string(index);
  link.X_RL.p = body.X_W.p;
  link.mass_kg = body.mass_kg;
  link.inertia_kg_m2 = InertiaOf(body);
  return link;
}

RobotModel TreeOf(const Setup& setup) {
  const bool flies = setup.joints[0].kind == Joint::Kind::kFree;
  RobotModel model;
  model.type = "tree";
  model.fixed_base = !flies;
  model.footprint_radius_m = 0.02;
  model.height_m = 3;
  if (!flies) model.links = {Block("world", {0, 0, 3}, {0.04, 0.04, 0.04}, 1)};
  for (std::size_t i = 0; i < setup.bodies.size(); ++i) {
    const Joint& of = setup.joints[i];
    const int child = static_cast<int>(model.links.size());
    model.links.push_back(LinkOf(setup.bodies[i], static_cast<int>(i)));
    if (of.kind == Joint::Kind::kFree) {
      model.links.back().collisions = {{Sphere{0.02}, {}, {}, 1, false}};
      continue;
    }
    JointModel joint;
    joint.name = "joint" + std::to_string(i);
    joint.kind = of.kind == Joint::Kind::kBall     ? JointModel::Kind::kBall
                 : of.kind == Joint::Kind::kSlider ? JointModel::Kind::kSlider
                                                   : JointModel::Kind::kHinge;
    joint.parent = flies ? of.parent : of.parent + 1;
    joint.child = child;
    joint.p_RJ = of.p_W;
    joint.axis_R = of.axis_W;
    joint.stiffness = of.stiffness;
    joint.damping = of.damping;
    joint.rest = of.rest;
    model.joints.push_back(joint);
  }
  return model;
}

class Coopdyn : public Engine {
 public:
  Coopdyn(const Setup& setup, double step_s) {
    scene_.step_length = std::llround(step_s * 1e9);
    scene_.SetGravity(setup.gravity_m_s2).SetFloorFriction(1);
    std::size_t next = 0;
    if (setup.joints.empty()) {
      for (const Body& body : setup.bodies) {
        scene_.Add(body.shape, body.X_W, body.mass_kg, body.friction);
        bodies_.push_back(body.mass_kg > 0 ? next++ : kStatic);
      }
    } else {
      RobotModel tree = TreeOf(setup);
      next = tree.fixed_base ? 1 : 0;
      scene_.robot_model = std::make_shared<const RobotModel>(std::move(tree));
      scene_.AddRobot(0, 0);
      for (std::size_t i = 0; i < setup.bodies.size(); ++i) bodies_.push_back(next++);
    }
    scene_.Build();
    if (!scene_.built()) throw std::runtime_error(scene_.diagnostics().ToString());
    auto frame = scene_.Capture();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      still_.push_back({setup.bodies[i].X_W.p, setup.bodies[i].X_W.q, Vector3::Zero(), Vector3::Zero()});
      if (bodies_[i] == kStatic) continue;
      BodyState& body = frame->bodies.at(bodies_[i]);
      body.v_WB = setup.bodies[i].v_W;
      body.w_WB = setup.bodies[i].w_W;
    }
    scene_.Restore(*frame);
  }

  void Run(int steps) override { scene_.Run(steps); }

  std::vector<Motion> Motions() override {
    const auto frame = scene_.Capture();
    std::vector<Motion> motions = still_;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i] == kStatic) continue;
      const BodyState& body = frame->bodies[bodies_[i]];
      motions[i] = {body.p_WB, body.orientation(), body.v_WB, body.w_WB};
      if (body.frozen()) motions[i].p_W.setConstant(std::numeric_limits<double>::quiet_NaN());  // it exploded
    }
    return motions;
  }

 private:
  static constexpr std::size_t kStatic = ~std::size_t{0};
  PhysicsScene scene_;
  std::vector<std::size_t> bodies_;  // in the frame
  std::vector<Motion> still_;
};

}  // namespace

std::unique_ptr<Engine> MakeCoopdyn(const Setup& setup, double step_s) {
  return std::make_unique<Coopdyn>(setup, step_s);
}

}  // namespace coopdyn::frontier
