// SPDX-License-Identifier: MIT
#include "server/physics/start_check.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"

namespace coopdyn {

namespace {

constexpr double kTolerance_m = 1e-3;

std::string Metres(double length_m) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g m", length_m);
  return text;
}

std::string NameOf(const Owner& owner) {
  return owner.kind + " " + owner.name;
}

double Depth(const PlacedPart& a, const PlacedPart& b) {
  double depth = 0;
  const ContactList contacts = Collide(a, b, 0);
  for (const ContactPoint& point : contacts.all()) depth = std::max(depth, point.depth_m);
  // Colliders may miss a shape that lies wholly within another.
  return std::max({depth, DepthInside(b.part.shape, b.place, a.place.position()),
                   DepthInside(a.part.shape, a.place, b.place.position())});
}

double DepthOfPair(const OdeWorld& ode, const Owner& a, const Owner& b) {
  double depth = 0;
  const auto parts_a = ode.PartsOf(a), parts_b = ode.PartsOf(b);
  for (std::size_t i = 0; i < parts_a.size(); ++i) {
    for (std::size_t j = 0; j < parts_b.size(); ++j) {
      depth = std::max(depth, Depth({parts_a[i], ode.PlaceOf(a, i)}, {parts_b[j], ode.PlaceOf(b, j)}));
    }
  }
  return depth;
}

double DepthBelowFloor(const OdeWorld& ode, const Owner& owner) {
  double below = 0;
  const auto parts = ode.PartsOf(owner);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PlacedRotation place = ode.PlaceOf(owner, i);
    Matrix3 R;
    R << place.R[0], place.R[1], place.R[2], place.R[4], place.R[5], place.R[6], place.R[8], place.R[9],
        place.R[10];
    below = std::max(below, HalfExtents(parts[i].shape, R).z() - place.p[2]);
  }
  return below;
}

/// Fidelity rolling and planar need wheels that their formulas fit.
void CheckFidelity(const RobotEntry& entry, Diagnostics& diagnostics) {
  if (entry.fidelity == Fidelity::kFull) return;
  const std::string name = entry.fidelity == Fidelity::kPlanar ? "planar" : "rolling";
  const std::string who = "robot " + entry.name + ": fidelity " + name;
  std::string why;
  if (entry.model->has_actuators() && !FindWheels(*entry.model, why)) {
    diagnostics.Error(entry.where,
                      who + " does not fit " + entry.model->type + ", since " + why + ": use fidelity full");
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

void CheckStart(OdeWorld& ode, std::span<const BodyState> bodies, Diagnostics& diagnostics) {
  BroadPhase broad_phase(ode);
  const std::size_t dynamic = static_cast<std::size_t>(ode.first_static);
  for (std::size_t i = 0; i < dynamic; ++i) {
    Owner& owner = ode.owners[i];
    const BodyState& body = bodies[static_cast<std::size_t>(owner.first_body)];
    if (owner.one_body != nullptr) ode.TakeSlot(owner, body);
    if (owner.robot >= 0) {
      broad_phase.spaces()[static_cast<std::size_t>(owner.robot)] = SpaceOf(owner, body, 0);
    }
    const double below = DepthBelowFloor(ode, owner);
    if (below > kTolerance_m) {
      diagnostics.Error(owner.where,
                        NameOf(owner) + " starts " + Metres(below) + " below the floor (z = 0): move it up");
    }
  }
  const std::vector<std::uint8_t> all(dynamic, 1);
  for (const auto& [a, b] : broad_phase.FindPairs(ode, all)) {
    const double depth = DepthOfPair(ode, ode.owners[a], ode.owners[b]);
    if (depth <= kTolerance_m) continue;
    // Of two that move, the later one is to be moved; static things stay.
    const bool static_b = b >= dynamic;
    const Owner& moved = ode.owners[static_b ? a : b];
    const Owner& other = ode.owners[static_b ? b : a];
    diagnostics.Error(moved.where,
                      NameOf(moved) + " starts " + Metres(depth) + " inside " + other.name + ": move it");
  }
  ode.FreeSlots();
}

}  // namespace coopdyn
