// SPDX-License-Identifier: MIT
// Narrow phase: which shapes touch where. Pure but for the Collider's scratch geoms.
// Only server/physics includes this file.
#pragma once

#include <vector>

#include "server/physics/closed_forms.h"
#include "server/physics/collider.h"
#include "server/physics/things.h"

namespace coopdyn {

/// Contacts of A with B; normals from B to A. Upright robots and walls also across a gap of `margin_m`.
ContactList Collide(Collider& collider, const PlacedPart& a, const PlacedPart& b, double margin_m);
/// Contacts of A with the floor.
ContactList CollideFloor(Collider& collider, const PlacedPart& a, double margin_m);

/// A contact of two things.
struct FoundContact {
  ContactPoint point;
  const Part* a = nullptr;
  const Part* b = nullptr;  // null: the floor
  int wheel = -1;           // as in ContactList
};

/// Appends all that touches between A and B to `found`.
void FindContacts(Collider& collider, const Actor& a, const Actor& b, double margin_m,
                  std::vector<FoundContact>& found);
void FindFloorContacts(Collider& collider, const Actor& a, double margin_m, std::vector<FoundContact>& found);

}  // namespace coopdyn
