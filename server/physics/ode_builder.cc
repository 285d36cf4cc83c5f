// SPDX-License-Identifier: MIT
#include <utility>

#include "server/physics/ode_setup.h"
#include "server/physics/ode_world.h"

namespace coopdyn {

namespace {

dQuaternion& CopyTo(dQuaternion& to, const Quaternion& q) {
  to[0] = q.w();
  to[1] = q.x();
  to[2] = q.y();
  to[3] = q.z();
  return to;
}

dGeomID MakeGeom(const Shape& shape, dSpaceID space) {
  if (const Box* box = std::get_if<Box>(&shape)) {
    return dCreateBox(space, box->size_m.x(), box->size_m.y(), box->size_m.z());
  }
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&shape)) {
    return dCreateCylinder(space, cylinder->radius_m, cylinder->length_m);
  }
  return dCreateSphere(space, std::get<Sphere>(shape).radius_m);
}

const char* KindOf(const Shape& shape) {
  constexpr const char* kKinds[] = {"box", "cylinder", "sphere"};
  return kKinds[shape.index()];
}

/// Fills an OdeWorld, bodies first, in the order of Frame::bodies.
class Builder {
 public:
  explicit Builder(const Scene& scene) : scene_(scene), ode_(std::make_unique<OdeWorld>()) {}

  std::unique_ptr<OdeWorld> Build() {
    EnsureOde();
    MakeWorld();
    for (const SceneObject& object : scene_.objects) {
      if (object.body >= 0) AddObject(object.object, AddBody(object.object));
    }
    ode_->first_robot = static_cast<int>(ode_->owners.size());
    for (std::size_t i = 0; i < scene_.robots.size(); ++i) AddRobot(static_cast<int>(i));
    ode_->first_static = static_cast<int>(ode_->owners.size());
    for (const SceneObject& object : scene_.objects) {
      if (object.body < 0) AddObject(object.object, -1);
    }
    return std::move(ode_);
  }

 private:
  void MakeWorld() {
    ode_->threading.reset(dThreadingAllocateSelfThreadedImplementation());
    ode_->world.reset(dWorldCreate());
    dWorldSetStepThreadingImplementation(ode_->world.get(),
                                         dThreadingImplementationGetFunctions(ode_->threading.get()),
                                         ode_->threading.get());
    ode_->contacts.reset(dJointGroupCreate(0));
    ode_->geoms.reset(dSimpleSpaceCreate(nullptr));
    ode_->floor = dCreatePlane(ode_->geoms.get(), 0, 0, 1, 0);
    dWorldSetGravity(ode_->world.get(), 0, 0, -scene_.scenario->simulation.gravity_m_s2);
  }

  int AddBody(double mass_kg, const Vector3& inertia_kg_m2, const Pose& X_WB) {
    dBodyID body = dBodyCreate(ode_->world.get());
    dMass mass;
    dMassSetParameters(&mass, mass_kg, 0, 0, 0, inertia_kg_m2.x(), inertia_kg_m2.y(), inertia_kg_m2.z(), 0, 0,
                       0);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, X_WB.p.x(), X_WB.p.y(), X_WB.p.z());
    dQuaternion q;
    dBodySetQuaternion(body, CopyTo(q, X_WB.q));
    dBodySetAutoDisableFlag(body, 0);
    ode_->bodies.push_back(body);
    return static_cast<int>(ode_->bodies.size()) - 1;
  }
  int AddBody(const WorldObject& object) {
    return AddBody(object.mass_kg, SolidInertia(object.shape, object.mass_kg), object.X_WO);
  }

  /// `X_BG`: of the shape in its body, or in the world if it has none.
  Part& AddPart(const Shape& shape, double friction, int body, const Pose& X_BG) {
    Part part{shape, body, friction};
    part.geom = MakeGeom(shape, ode_->geoms.get());
    part.half_m = HalfExtents(shape, X_BG.q);
    dQuaternion q;
    CopyTo(q, X_BG.q);
    if (body < 0) {
      dGeomSetPosition(part.geom, X_BG.p.x(), X_BG.p.y(), X_BG.p.z());
      dGeomSetQuaternion(part.geom, q);
    } else {
      dGeomSetBody(part.geom, ode_->bodies[static_cast<std::size_t>(body)]);
      if (!X_BG.p.isZero(0) || X_BG.q.vec().squaredNorm() > 0) {
        dGeomSetOffsetPosition(part.geom, X_BG.p.x(), X_BG.p.y(), X_BG.p.z());
        dGeomSetOffsetQuaternion(part.geom, q);
      }
    }
    ode_->parts.push_back(std::move(part));
    return ode_->parts.back();
  }

  void AddObject(const WorldObject& object, int body) {
    Owner owner{KindOf(object.shape), object.name, object.where};
    owner.first_part = static_cast<int>(ode_->parts.size());
    owner.part_count = 1;
    owner.first_body = body;
    owner.body_count = body < 0 ? 0 : 1;
    AddPart(object.shape, object.friction, body, body < 0 ? object.X_WO : Pose{});
    if (body >= 0) ode_->parts.back().half_m = HalfExtents(object.shape, object.X_WO.q);
    ode_->owners.push_back(std::move(owner));
  }

  void AddRobot(int index) {
    const SceneRobot& robot = scene_.robots[static_cast<std::size_t>(index)];
    const RobotEntry& entry = robot.entry;
    Owner owner{"robot", entry.name, entry.where};
    owner.robot = index;
    owner.first_body = static_cast<int>(ode_->bodies.size());
    owner.p_BR = robot.X_BR.p;
    owner.up_B = robot.X_BR.q * Vector3::UnitZ();
    const OneBody& measures = OneBodyOf(*entry.model, entry.fidelity);
    owner.radius_m = measures.radius_m;
    owner.reach_m = measures.reach_m;
    owner.height_m = measures.height_m;
    owner.shell = measures.shell;
    if (robot.one_body()) {
      owner.one_body = &measures;
      owner.rest_z_m = measures.p_RB.z() + (measures.planar ? entry.X_WR.p.z() : 0);
      owner.body_count = 1;
      ode_->bodies.push_back(nullptr);
      ode_->motors.emplace_back();
    } else {
      constexpr double kHingeSlack_m = 0.01;  // links give way a little under load
      owner.radius_m += kHingeSlack_m;
      owner.reach_m += kHingeSlack_m;
      AddLinks(entry, owner);
      AddHinges(entry, owner);
    }
    ode_->owners.push_back(std::move(owner));
  }

  void AddLinks(const RobotEntry& entry, Owner& owner) {
    const RobotModel& model = *entry.model;
    owner.body_count = static_cast<int>(model.links.size());
    owner.first_part = static_cast<int>(ode_->parts.size());
    for (const LinkModel& link : model.links) {
      AddBody(link.mass_kg, link.inertia_kg_m2, entry.X_WR * link.X_RL * link.X_LI);
    }
    for (std::size_t k = 0; k < model.links.size(); ++k) {
      const LinkModel& link = model.links[k];
      for (const LinkShape& collision : link.collisions) {
        const Pose X_IG = link.X_LI.Inverse() * collision.X_LG;
        Part& part =
            AddPart(collision.shape, collision.friction, owner.first_body + static_cast<int>(k), X_IG);
        part.is_wheel = WheelSide(model, static_cast<int>(k), collision) >= 0;
        part.half_m = Vector3::Constant(BoundingRadius(collision.shape));
      }
    }
    owner.part_count = static_cast<int>(ode_->parts.size()) - owner.first_part;
  }

  /// `model` welded together; robots of one type and fidelity share it.
  const OneBody& OneBodyOf(const RobotModel& model, Fidelity fidelity) {
    for (std::size_t i = 0; i < ode_->one_bodies.size(); ++i) {
      if (ode_->one_bodies[i]->model == &model && fidelities_[i] == fidelity) return *ode_->one_bodies[i];
    }
    fidelities_.push_back(fidelity);
    ode_->one_bodies.push_back(
        std::make_unique<OneBody>(MakeOneBody(model, fidelity == Fidelity::kPlanar, scene_.floor.friction,
                                              scene_.scenario->simulation.gravity_m_s2)));
    OneBody& one_body = *ode_->one_bodies.back();
    if (fidelity == Fidelity::kFull) return one_body;  // only its measures are of interest
    for (Part& part : one_body.parts) {
      for (dGeomID& geom : part.loose_geoms) geom = MakeGeom(part.shape, ode_->geoms.get());
    }
    return one_body;
  }

  void AddHinges(const RobotEntry& entry, Owner& owner) {
    const RobotModel& model = *entry.model;
    std::array<dJointID, 2> motors{};
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
      const JointModel& joint = model.joints[j];
      const auto body = [&](int link) {
        return ode_->bodies[static_cast<std::size_t>(owner.first_body) + static_cast<std::size_t>(link)];
      };
      dJointID hinge = dJointCreateHinge(ode_->world.get(), nullptr);
      dJointAttach(hinge, body(joint.child),
                   body(joint.parent));  // so that its rate is the child's in the parent
      const Vector3 p = entry.X_WR * joint.p_RJ;
      const Vector3 axis = entry.X_WR.q * joint.axis_R;
      dJointSetHingeAnchor(hinge, p.x(), p.y(), p.z());
      dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
      owner.rows += 5;
      for (std::size_t side = 0; side < 2; ++side) {
        const int driven = side == 0 ? model.drive.left_joint : model.drive.right_joint;
        if (driven != static_cast<int>(j)) continue;
        motors[side] = hinge;
        dJointSetHingeParam(hinge, dParamFMax, model.drive.max_torque_nm);
        owner.rows += 1;
      }
    }
    ode_->motors.push_back(motors);
  }

  const Scene& scene_;
  std::unique_ptr<OdeWorld> ode_;
  std::vector<Fidelity> fidelities_;  // of ode_->one_bodies
};

}  // namespace

std::unique_ptr<OdeWorld> BuildOdeWorld(const Scene& scene) {
  return Builder(scene).Build();
}

}  // namespace coopdyn
