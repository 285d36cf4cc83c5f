// SPDX-License-Identifier: MIT
#include "server/physics/collider.h"

#include "server/physics/ode_setup.h"

namespace coopdyn {

Collider::Collider() {
  EnsureOde();
  a_ = MakeGeoms();
  b_ = MakeGeoms();
  floor_.reset(dCreatePlane(nullptr, 0, 0, 1, 0));
}

Collider::Geoms Collider::MakeGeoms() {
  return {OdeGeomPtr(dCreateBox(nullptr, 1, 1, 1)), OdeGeomPtr(dCreateCylinder(nullptr, 1, 1)),
          OdeGeomPtr(dCreateSphere(nullptr, 1))};
}

dGeomID Collider::Geoms::Become(const PlacedPart& part) {
  dGeomID geom = nullptr;
  if (const Box* of_box = std::get_if<Box>(&part.part->shape)) {
    geom = box.get();
    dGeomBoxSetLengths(geom, of_box->size_m.x(), of_box->size_m.y(), of_box->size_m.z());
  } else if (const Cylinder* of_cylinder = std::get_if<Cylinder>(&part.part->shape)) {
    geom = cylinder.get();
    dGeomCylinderSetParams(geom, of_cylinder->radius_m, of_cylinder->length_m);
  } else {
    geom = sphere.get();
    dGeomSphereSetRadius(geom, std::get<Sphere>(part.part->shape).radius_m);
  }
  dGeomSetPosition(geom, part.p[0], part.p[1], part.p[2]);
  dGeomSetRotation(geom, part.R);
  return geom;
}

ContactList Collider::Ask(dGeomID a, dGeomID b, int max_contacts) {
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

ContactList Collider::Collide(const PlacedPart& a, const PlacedPart& b, int max_contacts) {
  return Ask(a_.Become(a), b_.Become(b), max_contacts);
}

ContactList Collider::CollideFloor(const PlacedPart& a, int max_contacts) {
  return Ask(a_.Become(a), floor_.get(), max_contacts);
}

}  // namespace coopdyn
