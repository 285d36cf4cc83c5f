// SPDX-License-Identifier: MIT
// Checks from plan and side views whether a scenario's robots and things overlap. Pure; any thread.
#pragma once

#include <string>
#include <vector>

#include "server/model/scenario.h"

namespace coopdyn {

/// The footprint of a robot or thing, a circle or a rotated rectangle, and its height range. Contains the
/// whole body; exact for upright boxes, cylinders and spheres.
struct Standing {
  std::string name;
  SourceLine where;
  double x_m = 0, y_m = 0;
  double radius_m = 0;  // of a circle; 0 for a rectangle
  double half_length_m = 0, half_width_m = 0, yaw_rad = 0;
  double low_m = 0, high_m = 0;
};

std::vector<Standing> GroundPlan(const Scenario& scenario);

/// True if two things of different sections share a height and are less than a centimetre apart horizontally.
bool Overlap(const Standing& a, const Standing& b);

}  // namespace coopdyn
