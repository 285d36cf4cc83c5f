// SPDX-License-Identifier: MIT
// All that collides in a scene: robots and objects, and what they are made of. Built once; only `frozen`
// changes. Only server/physics includes this file.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/physics/mechanism.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A robot or an object. Its own parts do not collide with each other.
struct Owner {
  std::string kind;  // robot, box, cylinder, sphere
  std::string name;
  SourceLine where;
  int robot = -1;  // index into Scene::robots; -1: an object
  const Mechanism* mechanism = nullptr;
  std::size_t pool = 0;                              // of Things::pools: what kind of bodies it needs in ODE
  int first_body = 0;                                // of Frame::bodies; static: none
  BodyState fixed{};                                 // of a static object: where it stands
  bool frozen = false;                               // held in place: nothing is joined to its bodies
  std::size_t first_channel = 0, channel_count = 0;  // of Frame::channels; of objects none

  // Robots only.
  Vector3 p_BR = Vector3::Zero();   // R's origin in the first body
  Vector3 up_B = Vector3::UnitZ();  // R's z axis in the first body
  double rest_z_m = 0;              // of one body: height of its centre of mass at rest

  std::size_t body_count() const { return mechanism->bodies.size(); }
};

/// An owner and where it is.
struct Actor {
  const Owner& owner;
  const BodyState* bodies;

  std::span<const Part> parts() const { return owner.mechanism->parts; }
  PlacedPart Place(std::size_t part) const {
    const Part& of = owner.mechanism->parts[part];
    return {of, bodies[static_cast<std::size_t>(of.body)]};
  }
};

struct Things {
  std::vector<std::shared_ptr<const Mechanism>>
      mechanisms;             // each of a robot type once; shared with things before
  std::vector<Owner> owners;  // dynamic objects, then robots from `first_robot` on, then static objects
  std::size_t first_robot = 0;
  std::size_t first_static = 0;
  /// What ODE is asked to move: single bodies (null), and each mechanism of several.
  std::vector<const Mechanism*> pools{nullptr};
  std::vector<BodyState> start;  // of Frame::bodies

  Actor ActorOf(std::size_t owner, std::span<const BodyState> bodies) const {
    const Owner& info = owners[owner];
    if (owner >= first_static) return {info, &info.fixed};
    return {info, bodies.data() + info.first_body};
  }
};

/// The things of `scene`, which outlives them. `before` (null: none): of a scene with the same floor and
/// gravity, whose mechanisms they take over. @pre all masses and inertias are positive.
Things MakeThings(const Scene& scene, const Things* before = nullptr);

}  // namespace coopdyn
