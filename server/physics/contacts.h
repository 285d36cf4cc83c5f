// SPDX-License-Identifier: MIT
// Narrow phase: which shapes touch where, and the contact joints made of it.
// Only server/physics includes this file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/closed_forms.h"
#include "server/physics/ode_world.h"

namespace coopdyn {

/// A part and where it is.
struct PlacedPart {
  const Part& part;
  PlacedRotation place;
};

/// The contacts of one pair of shapes.
struct ContactList {
  static constexpr int kMax = 8;
  std::array<ContactPoint, kMax> points;
  int count = 0;
  int wheel = -1;  // which of the two is a wheel that rolls on the other here: 0 A, 1 B, −1 none

  std::span<const ContactPoint> all() const& { return {points.data(), static_cast<std::size_t>(count)}; }
  std::span<const ContactPoint> all() && = delete;  // would outlive its list
};

/// Contacts of A with B; normals from B to A. Upright robots and walls also across a gap of `margin_m`.
ContactList Collide(const PlacedPart& a, const PlacedPart& b, double margin_m);
/// Contacts of A with the floor.
ContactList CollideFloor(const OdeWorld& ode, const PlacedPart& a, double margin_m);

/// A contact of two owners.
struct FoundContact {
  ContactPoint point;
  const Part* a = nullptr;
  const Part* b = nullptr;  // null: the floor
  int wheel = -1;           // as in ContactList
};

/// All that touches between A and B, appended to `found`. Pure as far as others see.
void FindContacts(const OdeWorld& ode, const Owner& a, const Owner& b, double margin_m,
                  std::vector<FoundContact>& found);
void FindFloorContacts(const OdeWorld& ode, const Owner& a, double margin_m,
                       std::vector<FoundContact>& found);

/// What contact joints need to know of the substep.
struct JointMaker {
  OdeWorld& ode;
  std::span<const std::array<double, 2>> setpoints_rad_s;  // of the wheels, by robot
  double floor_friction = 1;
  double dt_s = 0;

  /// Makes contact joints between A and B (null: the floor). Bodies of frozen owners count as static. Returns
  /// the number of constraint rows. Friction: the slippier of the two decides (the smaller coefficient).
  /// Nothing bounces.
  int Join(std::span<const FoundContact> found, const Owner& a, const Owner* b) const;

 private:
  /// Constraint rows of a wheel of a OneBody that rolls on something.
  int JoinWheel(const FoundContact& found, const Owner& robot, dBodyID body, dBodyID other, int sign) const;
  int JoinParts(const FoundContact& found, dBodyID a, dBodyID b, bool flat) const;
  void Attach(dContact& contact, const ContactPoint& point, dBodyID a, dBodyID b) const;
};

}  // namespace coopdyn
