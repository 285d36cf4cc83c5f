// SPDX-License-Identifier: MIT
// Narrow phase: which shapes touch where, and the contact joints made of it.
// Only server/physics includes this file.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/closed_forms.h"
#include "server/physics/ode_world.h"

namespace coopdyn {

/// The contacts of one pair of shapes.
struct ContactList {
  static constexpr int kMax = 8;
  std::array<ContactPoint, kMax> points;
  int count = 0;

  std::span<const ContactPoint> all() const& { return {points.data(), static_cast<std::size_t>(count)}; }
  std::span<const ContactPoint> all() && = delete;  // would outlive its list
};

/// Contacts of A with B; normals from B to A.
ContactList Collide(const Part& a, const Part& b);
/// Contacts of A with the floor.
ContactList CollideFloor(const OdeWorld& ode, const Part& a);

/// Makes contact joints for all that touches between A and B; `b` null: the floor, of friction
/// `floor_friction`. Bodies of frozen owners count as static. Returns the number of constraint rows.
/// Friction: the slippier of the two decides (the smaller coefficient). Nothing bounces.
int AddContacts(OdeWorld& ode, const Owner& a, const Owner& b);
int AddFloorContacts(OdeWorld& ode, const Owner& a, double floor_friction);

}  // namespace coopdyn
