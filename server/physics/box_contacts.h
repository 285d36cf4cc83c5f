// SPDX-License-Identifier: MIT
// Where two boxes touch. Pure; any thread. Only server/physics includes this file.
#pragma once

#include <vector>

#include "server/physics/closed_forms.h"

namespace coopdyn {

/// Points where boxes A and B touch, or are less than `margin_m` apart; normals from B to A. All lie across
/// one plane: that of a face, which the face of the other one that looks at it cuts out of it (up to 8
/// points), or one point of two edges that cross. By the separating axis with the least overlap (S.
/// Gottschalk et al. (1996), "OBBTree", SIGGRAPH), faces before edges, so that what rests keeps its points
/// from step to step.
std::vector<ContactPoint> BoxContacts(const Box& a, const PlacedRotation& X_WA, const Box& b,
                                      const PlacedRotation& X_WB, double margin_m);

}  // namespace coopdyn
