// SPDX-License-Identifier: MIT
// ODE's collision tests for shapes that no closed form fits. Holds a few geoms that take on whatever is asked
// about. One thread each. Only server/physics includes this file.
#pragma once

#include <ode/ode.h>

#include <array>
#include <span>

#include "server/physics/ode_ptr.h"
#include "server/physics/part.h"

namespace coopdyn {

/// The contacts of one pair of shapes.
struct ContactList {
  static constexpr int kMax = 8;
  std::array<ContactPoint, kMax> points;
  int count = 0;
  int wheel = -1;  // which of the two is a wheel that rolls on the other here: 0 A, 1 B, −1 none

  std::span<const ContactPoint> all() const& { return {points.data(), static_cast<std::size_t>(count)}; }
  std::span<const ContactPoint> all() && = delete;  // would outlive its list
};

class Collider {
 public:
  Collider();

  /// Normals from B to A; at most `max_contacts`.
  ContactList Collide(const PlacedPart& a, const PlacedPart& b, int max_contacts);
  /// With the plane z = 0.
  ContactList CollideFloor(const PlacedPart& a, int max_contacts);

 private:
  struct Geoms {
    OdeGeomPtr box, cylinder, sphere;
    dGeomID Become(const PlacedPart& part);
  };
  static Geoms MakeGeoms();
  static ContactList Ask(dGeomID a, dGeomID b, int max_contacts);

  Geoms a_, b_;
  OdeGeomPtr floor_;
};

}  // namespace coopdyn
