// SPDX-License-Identifier: MIT
// Finds seeded places for a swarm or for copies of an object, clear of objects, robots and each other. Pure;
// any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/scenario.h"

namespace coopdyn {

/// The place of a robot with a circular footprint.
struct FloorPlace {
  double x_m = 0, y_m = 0, heading_rad = 0;
  double radius_m = 0;
};

struct SwarmRequest {
  int count = 0;
  double spacing_m = 0;  // minimum distance between two centres
  double radius_m = 0;   // of a robot's footprint
  double height_m = 0;   // of a robot; objects above it are no obstacles
  FloorArea area;        // footprints lie completely inside
  std::uint64_t seed = 1;
};

/// The radius of a vertical cylinder about the shape's centre that contains the shape when rotated by `q` and
/// then by any angle about the vertical. Exact for upright shapes, otherwise an upper bound.
double FootprintRadius(const Shape& shape, const Quaternion& q);

/// Up to `request.count` places, fewer if no more fit. The same arguments give the same places.
std::vector<FloorPlace> PlaceSwarm(const SwarmRequest& request, std::span<const WorldObject> objects,
                                   std::span<const FloorPlace> taken);

/// The horizontal distance of (x, y) from the footprint of `object`; 0 inside. Exact for upright shapes,
/// otherwise the distance from the bounding box's footprint.
double DistanceToShadow(const WorldObject& object, double x_m, double y_m);

/// The error message if only `fit` of `what` have found a place.
std::string DoNotFit(const SwarmRequest& request, std::size_t fit, const std::string& what);

/// Adds the copies of all `sections` to `scenario`, NAME_1 to NAME_count, at random headings, clear of its
/// objects, of the places `taken` and of each other. Then sorts objects in file order, the world's first.
/// Reports sections that do not fit, and copies whose name is in use.
void AddScattered(std::span<const ScatteredObjects> sections, std::span<const FloorPlace> taken,
                  Scenario& scenario, Diagnostics& diagnostics);

}  // namespace coopdyn
