// SPDX-License-Identifier: MIT
// Contacts of two convex solids of any shape: the shortest translation that separates them, and the points
// where their faces, edges and corners meet. Pure functions; any thread. Only server/physics includes this
// file.
#pragma once

#include <vector>

#include "server/physics/closed_forms.h"

namespace coopdyn {

/// The shortest translation that separates A from B.
struct Separation {
  double depth_m = 0;              // negative: the gap between them
  Vector3 n_W = Vector3::UnitZ();  // from B to A
  Vector3 p_W = Vector3::Zero();   // in the middle of the overlap or gap
};

/// Distance that A must move along `n_W` to separate from B, m.
/// @pre here and below: A and B are boxes, cylinders, spheres, capsules or convex meshes
double OverlapAlong(const PlacedPart& a, const PlacedPart& b, const Vector3& n_W);
/// If the gap is `margin_m` or more, finds no more than a bound of it.
Separation FindSeparation(const PlacedPart& a, const PlacedPart& b, double margin_m = 0);
/// Contacts of A and B along `least`, also across gaps of up to `margin_m`: at least one, all with its
/// normal, the deepest one with its depth.
std::vector<ContactPoint> ContactsAlong(const PlacedPart& a, const PlacedPart& b, const Separation& least,
                                        double margin_m = 0);

}  // namespace coopdyn
