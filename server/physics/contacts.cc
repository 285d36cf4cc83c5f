// SPDX-License-Identifier: MIT
#include "server/physics/contacts.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

ContactList AsList(const ClosedForm& form) {
  ContactList list;
  if (form.contact) list.points[static_cast<std::size_t>(list.count++)] = *form.contact;
  return list;
}

ContactList WheelList(const ClosedForm& form, int wheel) {
  ContactList list = AsList(form);
  list.wheel = wheel;
  return list;
}

ContactList Reversed(ContactList list) {
  for (int i = 0; i < list.count; ++i) list.points[static_cast<std::size_t>(i)].n_W *= -1;
  if (list.wheel >= 0) list.wheel = 1 - list.wheel;
  return list;
}

/// The geom of a part, where the part is. `at`: A or B of its pair.
dGeomID GeomOf(const PlacedPart& placed, std::size_t at) {
  if (placed.part.geom != nullptr) return placed.part.geom;
  dGeomID geom = placed.part.loose_geoms[at];
  dGeomSetPosition(geom, placed.place.p[0], placed.place.p[1], placed.place.p[2]);
  dMatrix3 R;
  std::copy_n(placed.place.R, 12, R);
  dGeomSetRotation(geom, R);
  return geom;
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

/// Whether a closed form applies; what it found goes to `list`.
bool TryClosedForm(const PlacedPart& a, const PlacedPart& b, double margin_m, ContactList& list) {
  const Cylinder* cylinder = std::get_if<Cylinder>(&a.part.shape);
  if (cylinder == nullptr) return false;
  ClosedForm form;
  if (const Box* box = std::get_if<Box>(&b.part.shape)) {
    if (a.part.is_wheel) {
      form = WheelOnBox(cylinder->radius_m, a.place, *box, b.place, margin_m);
      list = WheelList(form, 0);
      return form.applies;
    }
    form = UprightCylinderAndBox(*cylinder, a.place, *box, b.place, margin_m);
  } else if (const Cylinder* other = std::get_if<Cylinder>(&b.part.shape)) {
    form = UprightCylinders(*cylinder, a.place, *other, b.place, margin_m);
  }
  list = AsList(form);
  return form.applies;
}

bool Near(const PlacedPart& a, const PlacedPart& b, double margin_m) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(a.place.p[i] - b.place.p[i]) > a.part.half_m[i] + b.part.half_m[i] + margin_m) return false;
  }
  return true;
}

/// The parts of `owner` that can be the first to touch `other`: between upright things that overlap in
/// height, a robot's shell alone.
struct PartRange {
  std::size_t first = 0, end = 0;
};
PartRange FirstToTouch(const OdeWorld& ode, const Owner& owner, const Owner& other) {
  const PartRange all{0, ode.PartsOf(owner).size()};
  if (owner.shell < 0) return all;
  const std::size_t shell = static_cast<std::size_t>(owner.shell);
  const std::size_t other_part = other.shell < 0 ? 0 : static_cast<std::size_t>(other.shell);
  if (other.shell < 0 && ode.PartsOf(other).size() != 1) return all;
  const PlacedRotation a = ode.PlaceOf(owner, shell), b = ode.PlaceOf(other, other_part);
  const Shape& shape = ode.PartsOf(other)[other_part].shape;
  double half_z = 0;
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&shape)) {
    half_z = cylinder->length_m / 2;
  } else if (const Box* box = std::get_if<Box>(&shape)) {
    half_z = box->size_m.z() / 2;
  } else {
    return all;
  }
  constexpr double kShared_m = 0.01;  // of their heights
  const double own_half_z = std::get<Cylinder>(ode.PartsOf(owner)[shell].shape).length_m / 2;
  if (!a.upright() || !b.upright() || std::abs(a.p[2] - b.p[2]) > own_half_z + half_z - kShared_m) return all;
  return {shell, shell + 1};
}

/// Velocity of the point `p` of `body`; static: 0.
Vector3 PointVelocity(dBodyID body, const Vector3& p) {
  if (body == nullptr) return Vector3::Zero();
  const double* x = dBodyGetPosition(body);
  const double* v = dBodyGetLinearVel(body);
  const double* w = dBodyGetAngularVel(body);
  return Vector3(v[0], v[1], v[2]) + Vector3(w[0], w[1], w[2]).cross(p - Vector3(x[0], x[1], x[2]));
}

void Copy(dVector3& to, const Vector3& from) {
  std::copy_n(from.data(), 3, to);
}

}  // namespace

ContactList Collide(const PlacedPart& a, const PlacedPart& b, double margin_m) {
  ContactList list;
  if (TryClosedForm(a, b, margin_m, list)) return list;
  if (TryClosedForm(b, a, margin_m, list)) return Reversed(list);
  // Four corners carry a box; the cylinder's colliders do not choose well among theirs, so they give all.
  const bool boxes = std::holds_alternative<Box>(a.part.shape) && std::holds_alternative<Box>(b.part.shape);
  return AskOde(GeomOf(a, 0), GeomOf(b, 1), boxes ? 4 : ContactList::kMax);
}

ContactList CollideFloor(const OdeWorld& ode, const PlacedPart& a, double margin_m) {
  const PlacedRotation& place = a.place;
  if (const Sphere* sphere = std::get_if<Sphere>(&a.part.shape)) {
    const double depth = sphere->radius_m - place.p[2];
    if (depth <= -margin_m) return {};
    return AsList({true, ContactPoint{{place.p[0], place.p[1], -depth}, Vector3::UnitZ(), depth}});
  }
  double half_z = 0;
  if (const Box* box = std::get_if<Box>(&a.part.shape)) {
    for (int i = 0; i < 3; ++i) half_z += std::abs(place.R[8 + i]) * box->size_m[i] / 2;
  } else {
    const Cylinder& cylinder = std::get<Cylinder>(a.part.shape);
    if (a.part.is_wheel) {
      const ClosedForm form = WheelOnFloor(cylinder.radius_m, place, margin_m);
      if (form.applies) return WheelList(form, 0);
    }
    const double rise = place.R[10];
    half_z = std::abs(rise) * cylinder.length_m / 2 +
             std::sqrt(std::max(0.0, 1 - rise * rise)) * cylinder.radius_m;
  }
  if (place.p[2] >= half_z) return {};
  return AskOde(GeomOf(a, 0), ode.floor, 4);
}

void FindContacts(const OdeWorld& ode, const Owner& a, const Owner& b, double margin_m,
                  std::vector<FoundContact>& found) {
  const auto parts_a = ode.PartsOf(a), parts_b = ode.PartsOf(b);
  const PartRange range_a = FirstToTouch(ode, a, b), range_b = FirstToTouch(ode, b, a);
  for (std::size_t i = range_a.first; i < range_a.end; ++i) {
    const PlacedPart part_a{parts_a[i], ode.PlaceOf(a, i)};
    for (std::size_t j = range_b.first; j < range_b.end; ++j) {
      const PlacedPart part_b{parts_b[j], ode.PlaceOf(b, j)};
      if (!Near(part_a, part_b, margin_m)) continue;
      const ContactList list = Collide(part_a, part_b, margin_m);
      for (const ContactPoint& point : list.all()) {
        found.push_back({point, &part_a.part, &part_b.part, list.wheel});
      }
    }
  }
}

void FindFloorContacts(const OdeWorld& ode, const Owner& a, double margin_m,
                       std::vector<FoundContact>& found) {
  const auto parts = ode.PartsOf(a);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (a.one_body != nullptr && a.one_body->planar && !parts[i].is_wheel) continue;
    PlacedPart part{parts[i], ode.PlaceOf(a, i)};
    const ContactList list = CollideFloor(ode, part, margin_m);
    for (const ContactPoint& point : list.all()) found.push_back({point, &part.part, nullptr, list.wheel});
  }
}

void JointMaker::Attach(dContact& contact, const ContactPoint& point, dBodyID a, dBodyID b) const {
  Copy(contact.geom.pos, point.p_W);
  Copy(contact.geom.normal, point.n_W);
  contact.geom.depth = std::max(0.0, point.depth_m);
  if (point.depth_m < 0) {
    // They may come as near as they are, and no nearer.
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = point.depth_m / dt_s;
  }
  dJointAttach(dJointCreateContact(ode.world.get(), ode.contacts.get(), &contact), a, b);
}

int JointMaker::JoinParts(const FoundContact& found, dBodyID a, dBodyID b, bool flat) const {
  const ContactPoint& point = found.point;
  dContact contact{};
  contact.surface.mu = std::min(found.a->friction, found.b == nullptr ? floor_friction : found.b->friction);
  int rows = 1;
  if (contact.surface.mu > 0) {
    contact.surface.mode = dContactApprox1;
    // The friction pyramid lies along the slip, so that sliding bodies brake alike in every direction.
    const Vector3 slip = PointVelocity(a, point.p_W) - PointVelocity(b, point.p_W);
    const Vector3 along = slip - slip.dot(point.n_W) * point.n_W;
    constexpr double kSliding_m_s = 0.01;
    rows = 3;
    if (flat) {
      // Upright robots do not lift each other: friction acts in the plane only.
      contact.surface.mode |= dContactFDir1 | dContactMu2;
      contact.surface.mu2 = 0;
      Copy(contact.fdir1, Vector3::UnitZ().cross(point.n_W).normalized());
      rows = 2;
    } else if (along.squaredNorm() > kSliding_m_s * kSliding_m_s) {
      contact.surface.mode |= dContactFDir1;
      Copy(contact.fdir1, along.normalized());
    }
  }
  Attach(contact, point, a, b);
  return rows;
}

int JointMaker::JoinWheel(const FoundContact& found, const Owner& robot, dBodyID body, dBodyID other,
                          int sign) const {
  const Part& wheel = *(found.wheel == 0 ? found.a : found.b);
  const Part* ground = found.wheel == 0 ? found.b : found.a;
  const OneBody& one = *robot.one_body;
  const std::size_t side = static_cast<std::size_t>(wheel.side);
  ContactPoint point = found.point;
  point.n_W *= sign;  // towards the robot
  // The rolling direction at mid-step: the robot turns on while it rolls.
  const double* R = dBodyGetRotation(body);
  const double half_turn = dBodyGetAngularVel(body)[2] * dt_s / 2;
  const double c = std::cos(half_turn), s = std::sin(half_turn);
  const Vector3 axle(c * R[1] - s * R[5], s * R[1] + c * R[5], R[9]);
  dContact contact{};
  contact.surface.mode = dContactFDir1 | dContactMotion1 | dContactMu2;
  Copy(contact.fdir1, axle.cross(point.n_W).normalized());
  contact.surface.motion1 =
      setpoints_rad_s[static_cast<std::size_t>(robot.robot)][side] * one.wheels.radius_m;
  const double friction = std::min(wheel.friction, ground == nullptr ? floor_friction : ground->friction);
  int rows = 3;
  if (one.planar) {
    // It has no weight in the solver, so its limits are forces. One wheel's row holds it sideways for both.
    contact.surface.mu = one.drive_n[side];
    contact.surface.mu2 = side == 0 ? one.sideways_n : 0;
    if (side != 0) rows = 2;
  } else {
    contact.surface.mode |= dContactApprox1;
    // At its load at rest the wheel pushes no more than its motor does.
    const double load_n = std::max(one.load_n[side], 1e-9);
    contact.surface.mu = std::min(friction, one.model->drive.max_torque_nm / (one.wheels.radius_m * load_n));
    contact.surface.mu2 = friction;
  }
  Attach(contact, point, body, other);
  return rows;
}

int JointMaker::Join(std::span<const FoundContact> found, const Owner& a, const Owner* b) const {
  int rows = 0;
  const bool flat = b != nullptr && a.one_body != nullptr && b->one_body != nullptr &&
                    (a.one_body->planar || b->one_body->planar);
  for (const FoundContact& contact : found) {
    dBodyID body_a = a.frozen ? nullptr : ode.BodyOf(a, *contact.a);
    dBodyID body_b = b == nullptr || b->frozen ? nullptr : ode.BodyOf(*b, *contact.b);
    const Owner* roller = contact.wheel == 0 ? &a : contact.wheel == 1 ? b : nullptr;
    dBodyID rolling = contact.wheel == 0 ? body_a : body_b;
    if (roller != nullptr && roller->one_body != nullptr && rolling != nullptr) {
      rows += JoinWheel(contact, *roller, rolling, contact.wheel == 0 ? body_b : body_a,
                        contact.wheel == 0 ? 1 : -1);
    } else {
      rows += JoinParts(contact, body_a, body_b, flat);
    }
  }
  return rows;
}

}  // namespace coopdyn
