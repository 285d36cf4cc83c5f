// SPDX-License-Identifier: MIT
#include "server/physics/contacts.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

PlacedRotation PlaceOf(const Part& part) {
  return {dGeomGetPosition(part.geom), dGeomGetRotation(part.geom)};
}

std::span<const Part> PartsOf(const OdeWorld& ode, const Owner& owner) {
  return std::span(ode.parts).subspan(static_cast<std::size_t>(owner.first_part),
                                      static_cast<std::size_t>(owner.part_count));
}

ContactList AsList(const ClosedForm& form) {
  ContactList list;
  if (form.contact) list.points[static_cast<std::size_t>(list.count++)] = *form.contact;
  return list;
}

ContactList Reversed(ContactList list) {
  for (int i = 0; i < list.count; ++i) list.points[static_cast<std::size_t>(i)].n_W *= -1;
  return list;
}

ContactList AskOde(dGeomID a, dGeomID b, int max_contacts) {
  std::array<dContactGeom, ContactList::kMax> found;
  ContactList list;
  list.count = dCollide(a, b, max_contacts, found.data(), sizeof(dContactGeom));
  for (std::size_t i = 0; i < static_cast<std::size_t>(list.count); ++i) {
    const dContactGeom& c = found[i];
    list.points[i] = {{c.pos[0], c.pos[1], c.pos[2]},
                      {c.normal[0], c.normal[1], c.normal[2]},
                      static_cast<double>(c.depth)};
  }
  return list;
}

ClosedForm TryClosedForm(const Part& a, const Part& b) {
  const Cylinder* cylinder = std::get_if<Cylinder>(&a.shape);
  if (cylinder == nullptr) return {};
  if (const Box* box = std::get_if<Box>(&b.shape)) {
    if (a.is_wheel) return WheelOnBox(cylinder->radius_m, PlaceOf(a), *box, PlaceOf(b));
    return UprightCylinderAndBox(*cylinder, PlaceOf(a), *box, PlaceOf(b));
  }
  if (const Cylinder* other = std::get_if<Cylinder>(&b.shape)) {
    return UprightCylinders(*cylinder, PlaceOf(a), *other, PlaceOf(b));
  }
  return {};
}

bool Near(const Part& a, const Part& b) {
  const double* p_a = dGeomGetPosition(a.geom);
  const double* p_b = dGeomGetPosition(b.geom);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(p_a[i] - p_b[i]) > a.half_m[i] + b.half_m[i]) return false;
  }
  return true;
}

/// Velocity of the point `p` of `body`; static: 0.
Vector3 PointVelocity(dBodyID body, const Vector3& p) {
  if (body == nullptr) return Vector3::Zero();
  const double* x = dBodyGetPosition(body);
  const double* v = dBodyGetLinearVel(body);
  const double* w = dBodyGetAngularVel(body);
  return Vector3(v[0], v[1], v[2]) + Vector3(w[0], w[1], w[2]).cross(p - Vector3(x[0], x[1], x[2]));
}

int AddJoints(OdeWorld& ode, std::span<const ContactPoint> points, dBodyID a, dBodyID b, double friction) {
  const auto copy = [](dVector3& to, const Vector3& from) { std::copy_n(from.data(), 3, to); };
  for (const ContactPoint& point : points) {
    dContact contact{};
    copy(contact.geom.pos, point.p_W);
    copy(contact.geom.normal, point.n_W);
    contact.geom.depth = point.depth_m;
    contact.surface.mu = friction;
    if (friction > 0) {
      contact.surface.mode = dContactApprox1;
      // The friction pyramid lies along the slip, so that sliding bodies brake alike in every direction.
      const Vector3 slip = PointVelocity(a, point.p_W) - PointVelocity(b, point.p_W);
      const Vector3 along = slip - slip.dot(point.n_W) * point.n_W;
      constexpr double kSliding_m_s = 0.01;
      if (along.squaredNorm() > kSliding_m_s * kSliding_m_s) {
        contact.surface.mode |= dContactFDir1;
        copy(contact.fdir1, along.normalized());
      }
    }
    dJointAttach(dJointCreateContact(ode.world.get(), ode.contacts.get(), &contact), a, b);
  }
  return static_cast<int>(points.size()) * (friction > 0 ? 3 : 1);
}

}  // namespace

ContactList Collide(const Part& a, const Part& b) {
  if (const ClosedForm form = TryClosedForm(a, b); form.applies) return AsList(form);
  if (const ClosedForm form = TryClosedForm(b, a); form.applies) return Reversed(AsList(form));
  // Four corners carry a box; the cylinder's colliders do not choose well among theirs, so they give all.
  const bool boxes = std::holds_alternative<Box>(a.shape) && std::holds_alternative<Box>(b.shape);
  return AskOde(a.geom, b.geom, boxes ? 4 : ContactList::kMax);
}

ContactList CollideFloor(const OdeWorld& ode, const Part& a) {
  const PlacedRotation place = PlaceOf(a);
  if (const Sphere* sphere = std::get_if<Sphere>(&a.shape)) {
    const double depth = sphere->radius_m - place.p[2];
    if (depth <= 0) return {};
    return AsList({true, ContactPoint{{place.p[0], place.p[1], -depth}, Vector3::UnitZ(), depth}});
  }
  double half_z = 0;
  if (const Box* box = std::get_if<Box>(&a.shape)) {
    for (int i = 0; i < 3; ++i) half_z += std::abs(place.R[8 + i]) * box->size_m[i] / 2;
  } else {
    const Cylinder& cylinder = std::get<Cylinder>(a.shape);
    if (a.is_wheel) {
      if (const ClosedForm form = WheelOnFloor(cylinder.radius_m, place); form.applies) return AsList(form);
    }
    const double rise = place.R[10];
    half_z = std::abs(rise) * cylinder.length_m / 2 +
             std::sqrt(std::max(0.0, 1 - rise * rise)) * cylinder.radius_m;
  }
  if (place.p[2] >= half_z) return {};
  return AskOde(a.geom, ode.floor, 4);
}

int AddContacts(OdeWorld& ode, const Owner& a, const Owner& b) {
  int rows = 0;
  for (const Part& part_a : PartsOf(ode, a)) {
    for (const Part& part_b : PartsOf(ode, b)) {
      if (!Near(part_a, part_b)) continue;
      const ContactList list = Collide(part_a, part_b);
      rows += AddJoints(ode, list.all(), a.frozen ? nullptr : ode.BodyOf(part_a),
                        b.frozen ? nullptr : ode.BodyOf(part_b), std::min(part_a.friction, part_b.friction));
    }
  }
  return rows;
}

int AddFloorContacts(OdeWorld& ode, const Owner& a, double floor_friction) {
  int rows = 0;
  for (const Part& part : PartsOf(ode, a)) {
    const ContactList list = CollideFloor(ode, part);
    rows += AddJoints(ode, list.all(), ode.BodyOf(part), nullptr, std::min(part.friction, floor_friction));
  }
  return rows;
}

}  // namespace coopdyn
