// SPDX-License-Identifier: MIT
// The bodies, joints and shapes of a scene in ODE. Whoever holds the world uses it; no locks.
// Only server/physics includes this file.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "server/physics/closed_forms.h"
#include "server/physics/one_body.h"
#include "server/physics/part.h"
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

/// A thing that collides as a whole: a robot or an object. Its own parts do not collide with each other.
struct Owner {
  std::string kind;  // robot, box, cylinder, sphere
  std::string name;
  SourceLine where;
  int robot = -1;                      // index into Scene::robots; -1: an object
  int first_part = 0, part_count = 0;  // of OdeWorld::parts; none for a OneBody
  int first_body = 0, body_count = 0;  // none: static
  int rows = 0;                        // constraint rows of its own joints
  bool frozen = false;                 // held in place: its bodies are disabled and nothing is joined to them

  // Robots only.
  const OneBody* one_body = nullptr;  // fidelity rolling and planar
  Vector3 p_BR = Vector3::Zero();     // R's origin in the first body
  Vector3 up_B = Vector3::UnitZ();    // R's z axis in the first body
  double radius_m = 0;                // of the vertical cylinder about R's z axis that holds it when upright
  double reach_m = 0;                 // of the sphere about R's origin that holds it however its links turn
  double height_m = 0;
  double rest_z_m = 0;  // OneBody: height of its centre of mass at rest
  int shell = -1;       // the upright cylinder among its parts that covers all others in plan; -1: none
  int slot = -1;        // OneBody: its place in OdeWorld::slots and ::places for this substep; -1: none
};

/// A body of ODE that stands for one robot of fidelity rolling or planar during one substep.
struct Slot {
  dBodyID body = nullptr;
  const OneBody* loaded = nullptr;  // whose mass it has
};

/// Where a part of a OneBody is, as ODE keeps such things.
struct Place {
  double p[3];
  double R[12];
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

  std::vector<dBodyID> bodies;  // as Frame::bodies; null for a OneBody's
  std::vector<Part> parts;
  std::vector<Owner> owners;  // dynamic objects, then robots from `first_robot` on, then static objects
  int first_robot = 0;
  int first_static = 0;
  std::vector<std::array<dJointID, 2>> motors;  // left, right hinge of each robot
  std::vector<std::unique_ptr<OneBody>> one_bodies;

  // Robots of fidelity rolling and planar live in Frame-like states; those that touch something are lent a
  // body for one substep, in the order of robots, so that ODE remembers nothing of them.
  std::vector<Slot> slots;
  std::vector<Place> places;  // of the parts of robot k in its slot: from first_places[slot] + k
  std::vector<int> first_places;
  int slots_in_use = 0;

  /// Set when ODE threw in the middle of a step: then its threading object may not be freed (it asserts that
  /// its jobs are done) and is kept until the process ends.
  bool broken = false;

  std::span<const Part> PartsOf(const Owner& owner) const;
  PlacedRotation PlaceOf(const Owner& owner, std::size_t part) const;
  /// The body that a part moves with; null: static.
  dBodyID BodyOf(const Owner& owner, const Part& part) const;

  /// Gives a OneBody the next slot and places its parts. Its body is not loaded yet, and disabled.
  void TakeSlot(Owner& owner, const BodyState& state);
  /// Makes the slot's body the robot, enabled.
  void LoadSlot(const Owner& owner, const BodyState& state);
  void FreeSlots();
};

/// Builds `scene` in its initial poses. Every mass and inertia must be positive (CheckStart() says so).
std::unique_ptr<OdeWorld> BuildOdeWorld(const Scene& scene);

/// The exact state of a body; its sleep counter is 0.
BodyState ReadBody(dBodyID body);
/// Gives a body exactly this state, the last bit of its orientation included.
void WriteBody(dBodyID body, const BodyState& state);

}  // namespace coopdyn
