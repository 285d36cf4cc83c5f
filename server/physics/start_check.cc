// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <string>

#include "server/geometry/mesh.h"
#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"

namespace coopdyn {

namespace {

constexpr double kTolerance_m = 1e-3;
constexpr const char* kStuck = "it may never come out, so move it";

std::string Metres(double length_m) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g m", length_m);
  return text;
}

double Depth(Collider& collider, const PlacedPart& a, const PlacedPart& b) {
  double depth = 0;
  const ContactList contacts = Collide(collider, a, b, 0);
  for (const ContactPoint& point : contacts.all()) depth = std::max(depth, point.depth_m);
  // Colliders may miss a shape that lies wholly within another.
  return std::max({depth, DepthInside(b.part->shape, b.place(), a.place().position()),
                   DepthInside(a.part->shape, a.place(), b.place().position())});
}

double DepthOfPair(Collider& collider, const Actor& a, const Actor& b) {
  double depth = 0;
  for (std::size_t i = 0; i < a.parts().size(); ++i) {
    for (std::size_t j = 0; j < b.parts().size(); ++j) {
      depth = std::max(depth, Depth(collider, a.Place(i), b.Place(j)));
    }
  }
  return depth;
}

/// Whether the middle of `inner` lies inside a fixed part of `outer`: the shortest way out may then lead
/// through the floor.
bool HoldsMiddle(Collider& collider, const Actor& outer, const Actor& inner) {
  constexpr double kProbe_m = 1e-3;
  const Part probe{Sphere{kProbe_m}};
  const PlacedPart middle(probe, *inner.bodies);
  for (std::size_t i = 0; i < outer.parts().size(); ++i) {
    if (outer.parts()[i].body == 0 && Depth(collider, outer.Place(i), middle) > kProbe_m + kTolerance_m)
      return true;
  }
  return false;
}

/// Depth of the lowest point below the floor, m. Parts fixed in the world are ignored.
double DepthBelowFloor(const Actor& actor) {
  double below = 0;
  for (std::size_t i = 0; i < actor.parts().size(); ++i) {
    if (actor.thing.mechanism->fixed_base && actor.parts()[i].body == 0) continue;
    const PlacedPart part = actor.Place(i);
    if (const Mesh* mesh = std::get_if<Mesh>(&part.part->shape)) {
      for (const Vector3& v : mesh->data->vertices) below = std::max(below, -part.place().point(v).z());
      continue;
    }
    below = std::max(below, part.half_m.z() - part.p[2]);
  }
  return below;
}

/// Fidelity rolling and planar need wheels that fit their formulas.
void CheckFidelity(const RobotEntry& entry, Diagnostics& diagnostics) {
  if (entry.fidelity == Fidelity::kFull) return;
  const std::string name = entry.fidelity == Fidelity::kPlanar ? "planar" : "rolling";
  const std::string who = "robot " + entry.name + ": fidelity " + name;
  std::string why;
  if (entry.model->has_actuators() && !FindWheels(*entry.model, why)) {
    diagnostics.Error(entry.where,
                      who + " does not fit " + entry.model->type + ", since " + why + ": use fidelity full");
  }
  if (entry.model->has_limbs()) {
    diagnostics.Error(entry.where, who + " does not fit " + entry.model->type +
                                       ", which has joints other than wheels: use fidelity full");
  }
  const Vector3 up = entry.X_WR.q * Vector3::UnitZ();
  if (entry.fidelity == Fidelity::kPlanar && up.z() < 1 - 1e-9) {
    diagnostics.Error(entry.where, who + " needs an upright robot: use fidelity rolling or full");
  }
}

}  // namespace

void CheckModels(const Scene& scene, Diagnostics& diagnostics) {
  for (const SceneRobot& robot : scene.robots) {
    const RobotEntry& entry = robot.entry;
    for (const LinkModel& link : entry.model->links) {
      if (link.mass_kg > 0 && link.inertia_kg_m2.minCoeff() > 0) continue;
      diagnostics.Error(entry.where, "robot " + entry.name + ": link " + link.name + " of " +
                                         entry.model->type + " needs a mass and moments of inertia above 0");
    }
    CheckFidelity(entry, diagnostics);
  }
}

std::vector<ThingPair> PairsOfChosen(const Things& things, std::span<const BodyState> bodies,
                                     std::span<const std::uint8_t> chosen) {
  constexpr double kMargin_m = 0.01;  // of robots
  if (std::ranges::count(chosen, std::uint8_t{1}) == 0) return {};
  BroadPhase broad_phase(things, bodies);
  for (std::size_t i = 0; i < things.first_static; ++i) {
    const Thing& thing = things.all[i];
    if (thing.robot < 0) continue;
    const BodyState& first = bodies[static_cast<std::size_t>(thing.first_body)];
    broad_phase.spaces()[static_cast<std::size_t>(thing.robot)] = SpaceOf(thing, first, kMargin_m);
  }
  std::vector<ThingPair> pairs = broad_phase.FindPairs(std::vector<std::uint8_t>(things.first_static, 1));
  std::erase_if(pairs,
                [&](const ThingPair& pair) { return chosen[pair.first] == 0 && chosen[pair.second] == 0; });
  return pairs;
}

std::vector<std::uint32_t> NearChosen(const Things& things, std::span<const std::uint8_t> chosen,
                                      std::span<const ThingPair> pairs) {
  std::vector<std::uint32_t> near;
  for (const auto& [a, b] : pairs) {
    if (chosen[a] == chosen[b]) continue;
    const std::uint32_t other = chosen[a] != 0 ? b : a;
    if (other < things.first_static) near.push_back(other);
  }
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

std::string PlacementFault(const Scene& scene, const Things& things, std::span<const BodyState> bodies,
                           std::span<const std::uint8_t> chosen, std::span<const ThingPair> pairs) {
  for (std::size_t i = 0; i < things.first_static; ++i) {
    if (chosen[i] == 0) continue;
    const Actor actor = things.ActorOf(i, bodies);
    const double below = DepthBelowFloor(actor);
    if (below > kTolerance_m) {
      return TitleOf(scene, actor.thing) + " would stand " + Metres(below) +
             " below the floor (z = 0): give it a higher place";
    }
  }
  Collider collider;
  for (const auto& [a, b] : pairs) {
    const double depth = DepthOfPair(collider, things.ActorOf(a, bodies), things.ActorOf(b, bodies));
    if (depth <= kTolerance_m) continue;
    const Thing& put = things.all[chosen[a] != 0 ? a : b];
    const Thing& other = things.all[chosen[a] != 0 ? b : a];
    return TitleOf(scene, put) + " would stand " + Metres(depth) + " inside " + NameOf(scene, other) +
           ": give it another place";
  }
  return {};
}

void CheckStart(const Scene& scene, const Things& things, Diagnostics& diagnostics) {
  const bool overlaps = scene.scenario->simulation.overlaps;
  const auto say = [&](const Thing& thing, const std::string& text, const char* otherwise,
                       bool is_held = false) {
    const SourceLine& where = WhereOf(scene, thing);
    const std::string whole = TitleOf(scene, thing) + " starts " + text;
    if (!overlaps)
      diagnostics.Error(where, whole + ": " + otherwise);
    else if (is_held)
      diagnostics.Warning(where, whole + ", more than half of it: " + kStuck);
    else
      diagnostics.Mended(where, whole + (thing.mechanism->is_soft() ? ": its springs push it out"
                                                                    : ": it is pushed out slowly"));
  };
  BroadPhase broad_phase(things, things.bodies);
  Collider collider;
  for (std::size_t i = 0; i < things.first_static; ++i) {
    const Actor actor = things.ActorOf(i, things.bodies);
    const Thing& thing = actor.thing;
    if (thing.robot >= 0) {
      broad_phase.spaces()[static_cast<std::size_t>(thing.robot)] = SpaceOf(thing, *actor.bodies, 0);
    }
    const double below = DepthBelowFloor(actor);
    if (below > kTolerance_m) {
      say(thing, Metres(below) + " below the floor (z = 0)", "move it up");
    }
  }
  const std::vector<std::uint8_t> all(things.first_static, 1);
  for (const auto& [a, b] : broad_phase.FindPairs(all)) {
    const double depth =
        DepthOfPair(collider, things.ActorOf(a, things.bodies), things.ActorOf(b, things.bodies));
    if (depth <= kTolerance_m) continue;
    // Reports the thing that is not fixed; of two, the later one.
    const auto is_fixed = [&](std::uint32_t i) {
      return i >= things.first_static || things.all[i].mechanism->fixed_base;
    };
    const bool stays_b = is_fixed(b) && !is_fixed(a);
    const Actor moved = things.ActorOf(stays_b ? a : b, things.bodies);
    const Actor other = things.ActorOf(stays_b ? b : a, things.bodies);
    const bool is_held =
        is_fixed(stays_b ? b : a) && !is_fixed(stays_b ? a : b) && HoldsMiddle(collider, other, moved);
    say(moved.thing, Metres(depth) + " inside " + NameOf(scene, other.thing), "move it", is_held);
  }
}

}  // namespace coopdyn
