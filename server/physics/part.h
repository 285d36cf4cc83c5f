// SPDX-License-Identifier: MIT
// One collision shape. Only server/physics includes this file.
#pragma once

#include <ode/ode.h>

#include <array>

#include "server/geometry/shape.h"

namespace coopdyn {

struct RobotModel;
struct LinkShape;

struct Part {
  Shape shape;
  int body = -1;           // index into Frame::bodies; -1: static, or of a OneBody
  double friction = 1;     // Coulomb
  bool is_wheel = false;   // a cylinder about a driven axle: rolls on one contact at its tread
  int side = -1;           // of a wheel of a OneBody: 0 left, 1 right
  dGeomID geom = nullptr;  // moves with its body; null for a OneBody's
  /// Of a OneBody: geoms that are put where they are needed, one for each place in a pair.
  std::array<dGeomID, 2> loose_geoms{};
  Vector3 p_BG = Vector3::Zero();  // of a OneBody: in its body
  Matrix3 R_BG = Matrix3::Identity();
  /// Half of a box along the world's axes that holds it in its present (robots: any) orientation.
  Vector3 half_m = Vector3::Zero();
};

/// The side (0 left, 1 right) of the driven wheel whose tread `collision` of link `link` is; -1: it is none.
int WheelSide(const RobotModel& model, int link, const LinkShape& collision);

}  // namespace coopdyn
