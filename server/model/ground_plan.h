// SPDX-License-Identifier: MIT
// Whether robots and things of a scenario stand clear of one another, seen from above and from the side.
// Pure; any thread.
#pragma once

#include <string>
#include <vector>

#include "server/model/scenario.h"

namespace coopdyn {

/// The shadow of a robot or thing on the floor, a circle or a turned rectangle, and how high it reaches. It
/// holds the whole body: exact for upright boxes, cylinders and spheres.
struct Standing {
  std::string name;
  SourceLine where;
  double x_m = 0, y_m = 0;
  double radius_m = 0;  // of a circle; 0: a rectangle
  double half_length_m = 0, half_width_m = 0, yaw_rad = 0;
  double low_m = 0, high_m = 0;
};

std::vector<Standing> GroundPlan(const Scenario& scenario);

/// Whether two of different sections come nearer than a centimetre from side to side, where both have a
/// height in common.
bool Overlap(const Standing& a, const Standing& b);

}  // namespace coopdyn
