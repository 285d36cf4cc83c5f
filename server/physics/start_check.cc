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

double Depth(const Part& a, const Part& b) {
  double depth = 0;
  const ContactList contacts = Collide(a, b);
  for (const ContactPoint& point : contacts.all()) depth = std::max(depth, point.depth_m);
  // Colliders may miss a shape that lies wholly within another.
  const PlacedRotation X_WA{dGeomGetPosition(a.geom), dGeomGetRotation(a.geom)};
  const PlacedRotation X_WB{dGeomGetPosition(b.geom), dGeomGetRotation(b.geom)};
  return std::max(
      {depth, DepthInside(b.shape, X_WB, X_WA.position()), DepthInside(a.shape, X_WA, X_WB.position())});
}

template <typename Visit>
void ForEachPart(const OdeWorld& ode, const Owner& owner, Visit visit) {
  for (int i = 0; i < owner.part_count; ++i)
    visit(ode.parts[static_cast<std::size_t>(owner.first_part) + static_cast<std::size_t>(i)]);
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
    if (entry.fidelity != Fidelity::kFull) {
      diagnostics.Warning(entry.where,
                          "robot " + entry.name + " runs with fidelity full, the only one of this version");
    }
  }
}

void CheckStart(OdeWorld& ode, Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(ode.first_static); ++i) {
    const Owner& owner = ode.owners[i];
    double below = 0;
    ForEachPart(ode, owner, [&](const Part& part) {
      const double* R = dGeomGetRotation(part.geom);
      Matrix3 rotation;
      rotation << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
      below =
          std::max(below, HalfExtents(part.shape, Quaternion(rotation)).z() - dGeomGetPosition(part.geom)[2]);
    });
    if (below > kTolerance_m) {
      diagnostics.Error(owner.where,
                        NameOf(owner) + " starts " + Metres(below) + " below the floor (z = 0): move it up");
    }
  }
  BroadPhase broad_phase(ode);
  for (const auto& [a, b] : broad_phase.FindPairs(ode)) {
    double depth = 0;
    ForEachPart(ode, ode.owners[a], [&](const Part& part_a) {
      ForEachPart(ode, ode.owners[b],
                  [&](const Part& part_b) { depth = std::max(depth, Depth(part_a, part_b)); });
    });
    if (depth <= kTolerance_m) continue;
    // Of two that move, the later one is to be moved; static things stay.
    const bool static_b = b >= static_cast<std::uint32_t>(ode.first_static);
    const Owner& moved = ode.owners[static_b ? a : b];
    const Owner& other = ode.owners[static_b ? b : a];
    diagnostics.Error(moved.where,
                      NameOf(moved) + " starts " + Metres(depth) + " inside " + other.name + ": move it");
  }
}

}  // namespace coopdyn
