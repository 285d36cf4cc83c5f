// SPDX-License-Identifier: MIT
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "tests/bench/frontier/engine.h"

namespace coopdyn::frontier {
namespace {

btVector3 To(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
Vector3 From(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
Quaternion From(const btQuaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

class Bullet : public Engine {
 public:
  Bullet(const Setup& setup, double step_s) : setup_(setup), step_s_(step_s) {
    world_.setGravity({0, 0, -setup.gravity_m_s2});
    if (setup.joints.empty()) {
      AddThing(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0), Body{});
      for (const Body& body : setup.bodies) {
        std::unique_ptr<btCollisionShape> shape;
        if (std::holds_alternative<Box>(body.shape)) {
          shape = std::make_unique<btBoxShape>(To(SizeOf(body) / 2));
        } else {
          shape = std::make_unique<btSphereShape>(SizeOf(body).x() / 2);
        }
        AddThing(std::move(shape), body);
      }
    } else {
      AddTree();
    }
  }
  ~Bullet() override {
    for (const auto& thing : things_) world_.removeRigidBody(thing.get());
    if (tree_) world_.removeMultiBody(tree_.get());
  }

  void Run(int steps) override {
    for (int i = 0; i < steps; ++i) {
      PullSprings();
      world_.stepSimulation(step_s_, 1, step_s_);
    }
  }

  std::vector<Motion> Motions() override {
    std::vector<Motion> motions;
    if (!tree_) {
      for (std::size_t i = 1; i < things_.size(); ++i) {
        const btRigidBody& body = *things_[i];
        motions.push_back({From(body.getWorldTransform().getOrigin()),
                           From(body.getWorldTransform().getRotation()), From(body.getLinearVelocity()),
                           From(body.getAngularVelocity())});
      }
      return motions;
    }
    const auto count = static_cast<std::size_t>(tree_->getNumLinks()) + 1;
    std::vector<btVector3> omegas(count), velocities(count);
    tree_->compTreeLinkVelocities(omegas.data(), velocities.data());
    for (std::size_t i = 0; i < setup_.bodies.size(); ++i) {
      const int link = LinkOf(i);
      const auto at = static_cast<std::size_t>(link + 1);
      btQuaternion q;
      tree_->localFrameToWorld(link, btMatrix3x3::getIdentity()).getRotation(q);
      motions.push_back({From(tree_->localPosToWorld(link, {0, 0, 0})), From(q),
                         From(q) * From(velocities[at]), From(q) * From(omegas[at])});
    }
    return motions;
  }

 private:
  void AddThing(std::unique_ptr<btCollisionShape> shape, const Body& body) {
    const Vector3 inertia = body.mass_kg > 0 ? InertiaOf(body) : Vector3(0, 0, 0);
    btRigidBody::btRigidBodyConstructionInfo info(body.mass_kg, nullptr, shape.get(), To(inertia));
    const Quaternion& q = body.X_W.q;
    info.m_startWorldTransform = btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), To(body.X_W.p));
    info.m_friction = body.friction;
    auto thing = std::make_unique<btRigidBody>(info);
    thing->setLinearVelocity(To(body.v_W));
    thing->setAngularVelocity(To(body.w_W));
    thing->setActivationState(DISABLE_DEACTIVATION);  // it would stop bodies slower than 0.8 m/s
    if (setup_.fast && body.mass_kg > 0) {
      thing->setCcdMotionThreshold(SizeOf(body).x() / 2);
      thing->setCcdSweptSphereRadius(0.9 * SizeOf(body).x() / 2);
    }
    world_.addRigidBody(thing.get());
    shapes_.push_back(std::move(shape));
    things_.push_back(std::move(thing));
  }

  bool flies() const { return setup_.joints[0].kind == Joint::Kind::kFree; }
  /// -1: the base.
  int LinkOf(std::size_t body) const { return static_cast<int>(body) - (flies() ? 1 : 0); }

  void AddTree() {
    const Body& first = setup_.bodies[0];
    const int links = static_cast<int>(setup_.bodies.size()) - (flies() ? 1 : 0);
    tree_ = flies() ? std::make_unique<btMultiBody>(links, first.mass_kg, To(InertiaOf(first)), false, false)
                    : std::make_unique<btMultiBody>(links, 1, btVector3(1, 1, 1), true, false);
    if (flies()) tree_->setBasePos(To(first.X_W.p));
    for (std::size_t i = flies() ? 1 : 0; i < setup_.bodies.size(); ++i) {
      const Joint& joint = setup_.joints[i];
      const Body& body = setup_.bodies[i];
      const Vector3 parent_W =
          joint.parent < 0 ? Vector3::Zero() : setup_.bodies[static_cast<std::size_t>(joint.parent)].X_W.p;
      const int link = LinkOf(i),
                parent = joint.parent < 0 ? -1 : LinkOf(static_cast<std::size_t>(joint.parent));
      const btVector3 inertia = To(InertiaOf(body)), axis = To(joint.axis_W),
                      to_joint = To(joint.p_W - parent_W), to_middle = To(body.X_W.p - joint.p_W);
      const btQuaternion same = btQuaternion::getIdentity();
      if (joint.kind == Joint::Kind::kBall) {
        tree_->setupSpherical(link, body.mass_kg, inertia, parent, same, to_joint, to_middle, true);
      } else if (joint.kind == Joint::Kind::kSlider) {
        tree_->setupPrismatic(link, body.mass_kg, inertia, parent, same, axis, to_joint, to_middle, true);
      } else {
        tree_->setupRevolute(link, body.mass_kg, inertia, parent, same, axis, to_joint, to_middle, true);
      }
    }
    tree_->finalizeMultiDof();
    tree_->setLinearDamping(0);
    tree_->setAngularDamping(0);
    tree_->setMaxCoordinateVelocity(1e6);
    if (flies()) {
      tree_->setBaseVel(To(first.v_W));
      tree_->setBaseOmega(To(first.w_W));
    } else if (setup_.joints[0].kind == Joint::Kind::kBall) {
      tree_->setJointVelMultiDof(0, first.w_W.data());
    }
    world_.addMultiBody(tree_.get());
  }

  /// Bullet has no springs and dampers for these joints: applies torques, as its users do.
  void PullSprings() {
    for (std::size_t i = 0; i < setup_.joints.size(); ++i) {
      const Joint& joint = setup_.joints[i];
      if (joint.stiffness == 0 && joint.damping == 0) continue;
      const int link = LinkOf(i);
      tree_->addJointTorque(link, joint.stiffness * (joint.rest - tree_->getJointPos(link)) -
                                      joint.damping * tree_->getJointVel(link));
    }
  }

  const Setup setup_;
  const double step_s_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> things_;  // the floor is the first
  std::unique_ptr<btMultiBody> tree_;
};

}  // namespace

std::unique_ptr<Engine> MakeBullet(const Setup& setup, double step_s) {
  return std::make_unique<Bullet>(setup, step_s);
}

}  // namespace coopdyn::frontier
