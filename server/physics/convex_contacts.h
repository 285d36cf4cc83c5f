// SPDX-License-Identifier: MIT
// Contacts of two convex solids whatever they are: the least way that parts them, and where their faces,
// edges and corners meet. Pure functions; any thread. Only server/physics includes this file.
#pragma once

#include <vector>

#include "server/physics/closed_forms.h"

namespace coopdyn {

/// The shortest way that parts A from B.
struct LeastWay {
  double depth_m = 0;              // ≤ 0: they are apart
  Vector3 n_W = Vector3::UnitZ();  // from B to A
  Vector3 p_W = Vector3::Zero();   // in the middle of what it parts; unless they are apart
};

/// By how much A must move along `n_W` until it is apart from B, m.
/// @pre all of these take boxes, cylinders, spheres, capsules and convex meshes
double OverlapAlong(const PlacedPart& a, const PlacedPart& b, const Vector3& n_W);
LeastWay FindLeastWay(const PlacedPart& a, const PlacedPart& b);
/// Where A and B meet, seen along `least`: at least one contact, all with its normal, one of them as deep.
std::vector<ContactPoint> ContactsAlong(const PlacedPart& a, const PlacedPart& b, const LeastWay& least);

}  // namespace coopdyn
