// SPDX-License-Identifier: MIT
// Narrow phase: finds where shapes touch. Pure except for the Collider's scratch geoms. Only server/physics
// includes this file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/physics/closed_forms.h"
#include "server/physics/ode.h"
#include "server/physics/things.h"

namespace coopdyn {

/// The contacts of one pair of shapes.
struct ContactList {
  static constexpr int kMax = 8;
  std::array<ContactPoint, kMax> points;
  int count = 0;
  int wheel = -1;  // which of the two is a wheel that rolls on the other: 0 A, 1 B, −1 none

  std::span<const ContactPoint> all() const& { return {points.data(), static_cast<std::size_t>(count)}; }
  std::span<const ContactPoint> all() && = delete;  // the span would outlive the list
};

/// A mesh in ODE's form.
class OdeMesh {
 public:
  explicit OdeMesh(const MeshData& mesh);
  dGeomID geom() const { return geom_.get(); }
  /// Whether the mesh is the whole surface of a convex solid.
  bool is_convex() const { return is_convex_; }

 private:
  std::vector<double> vertices_;
  std::vector<dTriIndex> indices_;
  OdeMeshDataPtr data_;
  OdeGeomPtr geom_;  // after data_, which it uses
  bool is_convex_;
};

/// ODE's collision tests for shapes that no closed form fits. Has a few scratch geoms that become the shapes
/// of each call. One thread each.
class Collider {
 public:
  Collider();

  /// Normals from B to A; at most `max_contacts`.
  ContactList Collide(const PlacedPart& a, const PlacedPart& b, int max_contacts);
  bool IsConvex(const PlacedPart& part) { return a_.IsConvex(part); }
  /// With the plane z = 0, also across a gap of `margin_m`.
  ContactList CollideFloor(const PlacedPart& a, int max_contacts, double margin_m);

 private:
  struct Geoms {
    OdeGeomPtr box, cylinder, sphere, capsule;
    std::map<std::uint64_t, OdeMesh> meshes;  // by MeshData::id, each made at its first use
    dGeomID Become(const PlacedPart& part);
    const OdeMesh& MeshOf(const MeshData& data);
    bool IsConvex(const PlacedPart& part);
  };
  static Geoms MakeGeoms();
  static ContactList Ask(dGeomID a, dGeomID b, int max_contacts);

  Geoms a_, b_;
  OdeGeomPtr floor_;
};

/// Contacts of A with B; normals from B to A. Convex shapes have contacts across a gap of kAhead_m, upright
/// robots and walls of `margin_m` too.
ContactList Collide(Collider& collider, const PlacedPart& a, const PlacedPart& b, double margin_m);
/// Contacts of A with the floor.
ContactList CollideFloor(Collider& collider, const PlacedPart& a, double margin_m);

/// A contact of two things.
struct FoundContact {
  ContactPoint point;
  const Part* a = nullptr;
  const Part* b = nullptr;  // null: the floor
  int wheel = -1;           // as in ContactList
};

/// Appends all contacts of A and B to `found`.
void FindContacts(Collider& collider, const Actor& a, const Actor& b, double margin_m,
                  std::vector<FoundContact>& found);
void FindFloorContacts(Collider& collider, const Actor& a, double margin_m, std::vector<FoundContact>& found);

}  // namespace coopdyn
