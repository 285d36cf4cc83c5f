// SPDX-License-Identifier: MIT
// The bodies, joints and shapes of a scene in ODE. Whoever holds the world uses it; no locks.
// Only server/physics includes this file.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

/// Frees an ODE object by the function made for it.
template <auto Destroy>
struct OdeDelete {
  template <typename T>
  void operator()(T* object) const {
    Destroy(object);
  }
};
using OdeWorldPtr = std::unique_ptr<std::remove_pointer_t<dWorldID>, OdeDelete<dWorldDestroy>>;
using OdeSpacePtr = std::unique_ptr<std::remove_pointer_t<dSpaceID>, OdeDelete<dSpaceDestroy>>;
using OdeGroupPtr = std::unique_ptr<std::remove_pointer_t<dJointGroupID>, OdeDelete<dJointGroupDestroy>>;
using OdeThreadingPtr = std::unique_ptr<std::remove_pointer_t<dThreadingImplementationID>,
                                        OdeDelete<dThreadingFreeImplementation>>;

/// One collision shape.
struct Part {
  Shape shape;
  dGeomID geom = nullptr;
  int body = -1;          // index into OdeWorld::bodies; -1: static
  double friction = 1;    // Coulomb
  bool is_wheel = false;  // a cylinder about a driven axle: rolls on one contact at its tread
  Vector3
      half_m;  // half of a box along the world's axes that holds it in its present (robots: any) orientation
};

/// A thing that collides as a whole: a robot or an object. Its own parts do not collide with each other.
struct Owner {
  std::string kind;  // robot, box, cylinder, sphere
  std::string name;
  SourceLine where;
  int robot = -1;  // index into Scene::robots; -1: an object
  int first_part = 0, part_count = 0;
  int first_body = 0, body_count = 0;  // none: static
  double radius_m = 0;  // of a sphere about its first body that holds it however its links turn
  int rows = 0;         // constraint rows of its own joints
  bool frozen = false;  // held in place: its bodies are disabled and nothing is joined to them
};

struct OdeWorld {
  OdeWorld() = default;
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  ~OdeWorld();

  OdeThreadingPtr threading;  // of this world alone: ODE's shared one would tie worlds together
  OdeWorldPtr world;
  OdeGroupPtr contacts;
  OdeSpacePtr geoms;  // owns the shapes and the floor; never asked for collisions
  dGeomID floor = nullptr;

  std::vector<dBodyID> bodies;  // as Frame::bodies
  std::vector<Part> parts;
  std::vector<Owner>
      owners;  // with bodies: dynamic objects, then robots; from `first_static` on: static objects
  int first_static = 0;
  std::vector<std::array<dJointID, 2>> motors;  // left, right hinge of each robot

  /// Set when ODE threw in the middle of a step: then its threading object may not be freed (it asserts that
  /// its jobs are done) and is kept until the process ends.
  bool broken = false;

  dBodyID BodyOf(const Part& part) const {
    return part.body < 0 ? nullptr : bodies[static_cast<std::size_t>(part.body)];
  }
};

/// Builds `scene` in its initial poses. Every mass and inertia must be positive (CheckStart() says so).
std::unique_ptr<OdeWorld> BuildOdeWorld(const Scene& scene);

/// The exact state of a body; its sleep counter is 0.
BodyState ReadBody(dBodyID body);
/// Gives a body exactly this state, the last bit of its orientation included.
void WriteBody(dBodyID body, const BodyState& state);

}  // namespace coopdyn
