// SPDX-License-Identifier: MIT
// Collision shapes and where they are. Only server/physics includes this file.
#pragma once

#include "server/physics/closed_forms.h"
#include "server/state/frame.h"

namespace coopdyn {

// What is this near the floor when the robot stands on it carries it.
inline constexpr double kSupportGap_m = 2e-4;

/// One collision shape of a mechanism.
struct Part {
  Shape shape;
  int body = 0;         // of the mechanism
  double friction = 1;  // Coulomb
  int wheel = -1;       // of the drive: a cylinder about a driven axle rolls on one contact at its tread
  Vector3 p_BG = Vector3::Zero();  // in its body
  Matrix3 R_BG = Matrix3::Identity();
};

/// A part in the world, as ODE keeps such things: rows of 4.
struct PlacedPart {
  PlacedPart(const Part& part, const BodyState& body);
  PlacedRotation place() const { return {p, R}; }

  const Part* part;
  double p[3];
  double R[12];
  /// Half of a box along the world's axes that holds it.
  Vector3 half_m;
};

}  // namespace coopdyn
