// SPDX-License-Identifier: MIT
// Seeded places for a swarm, or for the copies of an object: free of objects, of robots and of one another.
// Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/scenario.h"

namespace coopdyn {

/// A round robot on the floor.
struct FloorPlace {
  double x_m = 0, y_m = 0, heading_rad = 0;
  double radius_m = 0;
};

struct SwarmRequest {
  int count = 0;
  double spacing_m = 0;  // least distance between the centres of two of the swarm
  double radius_m = 0;   // of a robot's footprint
  double height_m = 0;   // of a robot: what is higher is no obstacle
  FloorArea area;        // robots stand wholly inside
  std::uint64_t seed = 1;
};

/// The radius of the upright cylinder about the shape's centre that holds it when turned by `q`, and by any
/// angle about the vertical besides. Exact for upright shapes, otherwise enough.
double FootprintRadius(const Shape& shape, const Quaternion& q);

/// Up to `request.count` places, fewer if no more fit. The same arguments give the same places.
std::vector<FloorPlace> PlaceSwarm(const SwarmRequest& request, std::span<const WorldObject> objects,
                                   std::span<const FloorPlace> taken);

/// The horizontal distance of (x, y) from the shadow that `object` casts on the floor; 0 inside. For upright
/// shapes exact, otherwise to the box around it.
double DistanceToShadow(const WorldObject& object, double x_m, double y_m);

/// What to tell if only `fit` of `what` have found a place.
std::string DoNotFit(const SwarmRequest& request, std::size_t fit, const std::string& what);

/// Adds the copies of all `sections` to `scenario`, NAME_1 to NAME_count, turned about the vertical at
/// random: clear of the objects there, of the places `taken` and of one another. Then objects are in the
/// order of the files again, the world's first. Reports sections that do not fit, and copies with another's
/// name.
void AddScattered(std::span<const ScatteredObjects> sections, std::span<const FloorPlace> taken,
                  Scenario& scenario, Diagnostics& diagnostics);

}  // namespace coopdyn
