// SPDX-License-Identifier: MIT
// The contacts of two boxes. Pure; any thread. Only server/physics includes this file.
#pragma once

#include <vector>

#include "server/physics/closed_forms.h"

namespace coopdyn {

/// Points where boxes A and B touch, or are less than `margin_m` apart; normals point from B to A. Either the
/// points of a face clipped by the opposite face of the other box (up to 8), or the one point of two crossing
/// edges. Chosen by the separating axis with the least overlap (S. Gottschalk et al. (1996), "OBBTree",
/// SIGGRAPH), faces before edges, so that resting boxes keep their points from step to step.
std::vector<ContactPoint> BoxContacts(const Box& a, const PlacedRotation& X_WA, const Box& b,
                                      const PlacedRotation& X_WB, double margin_m);

}  // namespace coopdyn
