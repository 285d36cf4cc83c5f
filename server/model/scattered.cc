// SPDX-License-Identifier: MIT
#include "server/model/scattered.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/model/values.h"
#include "server/model/world_sections.h"

namespace coopdyn {

namespace {

/// The copies of one section; empty with an error at its line if they do not fit.
std::vector<WorldObject> PlaceCopies(const ScatteredObjects& things, const Scenario& scenario,
                                     std::span<const FloorPlace> taken, Diagnostics& diagnostics) {
  const Vector3 half = HalfExtents(things.object.shape, things.object.X_WO.q);
  SwarmRequest request;
  request.count = static_cast<int>(things.count);
  request.radius_m = FootprintRadius(things.object.shape, things.object.X_WO.q);
  request.height_m = 2 * half.z();
  request.spacing_m = things.spacing_m.value_or(2.5 * request.radius_m);
  request.area = things.area.value_or(FloorArea{0, 0, scenario.floor.length_m, scenario.floor.width_m});
  request.seed = things.seed.value_or(scenario.simulation.seed);

  std::vector<WorldObject> copies;
  const auto error = [&](std::string text) { diagnostics.Error(things.object.where, std::move(text)); };
  if (request.spacing_m < 2 * request.radius_m) {
    error("'spacing' is the distance between the middles of two copies: at least " +
          FormatNumber(2 * request.radius_m) + " m, so that they are clear of one another however they turn");
    return copies;
  }
  const std::vector<FloorPlace> places = PlaceSwarm(request, scenario.objects, taken);
  if (places.size() < things.count) {
    error("only " + std::to_string(places.size()) + " of " + std::to_string(things.count) + " copies of [" +
          things.object.name + "] fit into the area of " + FormatNumber(request.area.length_m) + " x " +
          FormatNumber(request.area.width_m) + " m, " + FormatNumber(request.spacing_m) +
          " m apart and clear of what stands there: take fewer, a smaller spacing or a larger area");
    return copies;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    WorldObject& copy = copies.emplace_back(things.object);
    copy.name += "_" + std::to_string(i + 1);
    copy.X_WO.p = Vector3(places[i].x_m, places[i].y_m, half.z());
    copy.X_WO.q = FromRollPitchYaw(0, 0, places[i].heading_rad) * things.object.X_WO.q;
  }
  return copies;
}

}  // namespace

void AddScattered(std::span<const ScatteredObjects> sections, std::span<const FloorPlace> taken,
                  Scenario& scenario, Diagnostics& diagnostics) {
  if (sections.empty()) return;
  std::unordered_map<std::string, SourceLine> names;  // of the objects, in lower case
  for (const WorldObject& object : scenario.objects) names.emplace(ToLower(object.name), object.where);
  std::uint64_t wanted = 0;
  for (const ScatteredObjects& things : sections) {
    wanted += things.count;
    if (wanted > kMaxSwarms) {
      diagnostics.Error(things.object.where, "all copies together are more than " +
                                                 std::to_string(kMaxSwarms) + ": take smaller counts");
      return;
    }
    for (WorldObject& copy : PlaceCopies(things, scenario, taken, diagnostics)) {
      const auto [first, is_new] = names.emplace(ToLower(copy.name), copy.where);
      if (!is_new) {
        diagnostics.Error(copy.where, "a copy is called [" + copy.name + "] as another thing is (" +
                                          first->second.file + ":" + std::to_string(first->second.line) +
                                          "): give the section another name");
        break;
      }
      scenario.objects.push_back(std::move(copy));
    }
  }
  std::stable_sort(scenario.objects.begin(), scenario.objects.end(),
                   [&scenario](const WorldObject& a, const WorldObject& b) {
                     const bool world_a = a.where.file == scenario.world.file;
                     const bool world_b = b.where.file == scenario.world.file;
                     return world_a != world_b ? world_a : a.where.line < b.where.line;
                   });
}

}  // namespace coopdyn
