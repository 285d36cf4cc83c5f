// SPDX-License-Identifier: MIT
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/simulation/World.hpp>

#include "tests/bench/frontier/engine.h"

namespace coopdyn::frontier {
namespace {

namespace dyn = dart::dynamics;

class Dart : public Engine {
 public:
  Dart(const Setup& setup, double step_s) : setup_(setup) {
    world_->setTimeStep(step_s);
    world_->setGravity({0, 0, -setup.gravity_m_s2});
    // Its default, FCL, treats spheres as meshes.
    world_->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    if (setup.joints.empty()) {
      AddThing({Box{{100, 100, 1}}, {{0, 0, -0.5}, Quaternion::Identity()}});
      for (const Body& body : setup.bodies) bodies_.push_back(AddThing(body));
    } else {
      AddTree();
    }
  }

  void Run(int steps) override {
    for (int i = 0; i < steps; ++i) world_->step();
  }

  std::vector<Motion> Motions() override {
    std::vector<Motion> motions;
    for (const dyn::BodyNode* body : bodies_) {
      const Eigen::Isometry3d& X_W = body->getWorldTransform();
      motions.push_back({X_W.translation(), Quaternion(X_W.linear()), body->getCOMLinearVelocity(),
                         body->getAngularVelocity()});
    }
    return motions;
  }

 private:
  static void SetMass(const Body& body, dyn::BodyNode& node) {
    const Vector3 inertia = body.mass_kg > 0 ? InertiaOf(body) : Vector3(1, 1, 1);
    node.setInertia(
        {body.mass_kg > 0 ? body.mass_kg : 1, Vector3::Zero(), Eigen::Matrix3d(inertia.asDiagonal())});
  }

  static void SetMotion(const Body& body, dyn::FreeJoint& joint) {
    Eigen::Isometry3d X_W = Eigen::Isometry3d::Identity();
    X_W.translation() = body.X_W.p;
    X_W.linear() = body.X_W.q.toRotationMatrix();
    joint.setTransform(X_W, dyn::Frame::World());
    joint.setLinearVelocity(body.v_W);
    joint.setAngularVelocity(body.w_W);
  }

  dyn::BodyNode* AddThing(const Body& body) {
    const auto skeleton = dyn::Skeleton::create("s" + std::to_string(world_->getNumSkeletons()));
    const auto [joint, node] = skeleton->createJointAndBodyNodePair<dyn::FreeJoint>();
    SetMass(body, *node);
    std::shared_ptr<dyn::Shape> shape;
    if (std::holds_alternative<Box>(body.shape)) {
      shape = std::make_shared<dyn::BoxShape>(SizeOf(body));
    } else {
      shape = std::make_shared<dyn::SphereShape>(SizeOf(body).x() / 2);
    }
    auto* shape_node = node->createShapeNodeWith<dyn::CollisionAspect, dyn::DynamicsAspect>(shape);
    shape_node->getDynamicsAspect()->setFrictionCoeff(body.friction);
    SetMotion(body, *joint);
    skeleton->setMobile(body.mass_kg > 0);
    world_->addSkeleton(skeleton);
    return node;
  }

  template <typename JointType>
  dyn::BodyNode* AddLink(dyn::Skeleton& skeleton, const Joint& joint, const Body& body) {
    typename JointType::Properties properties;
    dyn::BodyNode* parent = joint.parent < 0 ? nullptr : bodies_[static_cast<std::size_t>(joint.parent)];
    const Vector3 parent_W =
        joint.parent < 0 ? Vector3::Zero() : setup_.bodies[static_cast<std::size_t>(joint.parent)].X_W.p;
    properties.mT_ParentBodyToJoint.translation() = joint.p_W - parent_W;
    properties.mT_ChildBodyToJoint.translation() = joint.p_W - body.X_W.p;
    if constexpr (requires { properties.mAxis; }) properties.mAxis = joint.axis_W;
    const std::string number = std::to_string(bodies_.size());  // unique, because it warns about equal names
    properties.mName = "joint" + number;
    const auto [made, node] = skeleton.createJointAndBodyNodePair<JointType>(
        parent, properties, dyn::BodyNode::AspectProperties("body" + number));
    if constexpr (requires { properties.mAxis; }) {
      made->setSpringStiffness(0, joint.stiffness);
      made->setDampingCoefficient(0, joint.damping);
      made->setRestPosition(0, joint.rest);
    } else {
      made->setVelocities(body.w_W);
    }
    SetMass(body, *node);
    return node;
  }

  void AddTree() {
    const auto skeleton = dyn::Skeleton::create("tree");
    for (std::size_t i = 0; i < setup_.bodies.size(); ++i) {
      const Joint& joint = setup_.joints[i];
      const Body& body = setup_.bodies[i];
      if (joint.kind == Joint::Kind::kFree) {
        const auto [made, node] = skeleton->createJointAndBodyNodePair<dyn::FreeJoint>();
        SetMass(body, *node);
        SetMotion(body, *made);
        bodies_.push_back(node);
      } else if (joint.kind == Joint::Kind::kBall) {
        bodies_.push_back(AddLink<dyn::BallJoint>(*skeleton, joint, body));
      } else if (joint.kind == Joint::Kind::kSlider) {
        bodies_.push_back(AddLink<dyn::PrismaticJoint>(*skeleton, joint, body));
      } else {
        bodies_.push_back(AddLink<dyn::RevoluteJoint>(*skeleton, joint, body));
      }
    }
    world_->addSkeleton(skeleton);
  }

  const Setup setup_;
  dart::simulation::WorldPtr world_ = dart::simulation::World::create();
  std::vector<dyn::BodyNode*> bodies_;
};

}  // namespace

std::unique_ptr<Engine> MakeDart(const Setup& setup, double step_s) {
  return std::make_unique<Dart>(setup, step_s);
}

}  // namespace coopdyn::frontier
