// SPDX-License-Identifier: MIT
#include "server/physics/contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/geometry/mesh.h"

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

/// Whether a closed form applies; what it found goes to `list`.
bool TryClosedForm(const PlacedPart& a, const PlacedPart& b, double margin_m, ContactList& list) {
  const Cylinder* cylinder = std::get_if<Cylinder>(&a.part->shape);
  if (cylinder == nullptr) return false;
  ClosedForm form;
  if (const Box* box = std::get_if<Box>(&b.part->shape)) {
    if (a.part->wheel >= 0) {
      form = WheelOnBox(cylinder->radius_m, a.place(), *box, b.place(), margin_m);
      list = WheelList(form, 0);
      return form.applies;
    }
    form = UprightCylinderAndBox(*cylinder, a.place(), *box, b.place(), margin_m);
  } else if (const Cylinder* other = std::get_if<Cylinder>(&b.part->shape)) {
    form = UprightCylinders(*cylinder, a.place(), *other, b.place(), margin_m);
  }
  list = AsList(form);
  return form.applies;
}

bool Near(const PlacedPart& a, const PlacedPart& b, double margin_m) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(a.p[i] - b.p[i]) > a.half_m[i] + b.half_m[i] + margin_m) return false;
  }
  return true;
}

/// A robot's upright shell, or an upright box or cylinder: what else there is cannot be the first to touch
/// another such thing that it overlaps in height.
struct Shell {
  std::size_t part = 0;
  double z = 0, half_z = 0;
};
std::optional<Shell> ShellOf(const Actor& actor) {
  const Mechanism& mechanism = *actor.thing.mechanism;
  if (mechanism.shell < 0 && mechanism.parts.size() != 1) return std::nullopt;
  Shell shell{mechanism.shell < 0 ? 0 : static_cast<std::size_t>(mechanism.shell)};
  const Part& part = mechanism.parts[shell.part];
  const BodyState& body = actor.bodies[static_cast<std::size_t>(part.body)];
  if (!std::holds_alternative<Box>(part.shape) && !std::holds_alternative<Cylinder>(part.shape))
    return std::nullopt;
  const PlacedPart placed(part, body);
  if (!placed.place().upright()) return std::nullopt;
  shell.z = placed.p[2];
  shell.half_z = placed.half_m.z();
  return shell;
}

Vector3 Column(const PlacedPart& part, int i) {
  return {part.R[i], part.R[4 + i], part.R[8 + i]};
}

/// An edge of A and one of B are parallel but for rounding. ODE takes their cross product for a direction
/// along which boxes may be apart, and they are, by rounding alone.
bool HasAlmostParallelEdges(const PlacedPart& a, const PlacedPart& b) {
  constexpr double kRounding = 1e-11;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double square = 0;  // of the cross product, as ODE computes it
      for (int k = 0; k < 3; ++k) {
        const double c = k == i ? 0 : Column(a, k).dot(Column(b, j));
        square += c * c;
      }
      if (square > 0 && square < kRounding * kRounding) return true;
    }
  }
  return false;
}

/// B, turned so little that no contact moves by more than rounding, about no axis of A.
PlacedPart Turned(PlacedPart b, const PlacedPart& a) {
  constexpr double kTurn_rad = 1e-9;
  const Vector3 axis = (Column(a, 0) + 2 * Column(a, 1) + 3 * Column(a, 2)).normalized();
  for (int i = 0; i < 3; ++i) {
    const Vector3 turned = Column(b, i) + kTurn_rad * axis.cross(Column(b, i));
    for (int row = 0; row < 3; ++row) b.R[4 * row + i] = turned[row];
  }
  return b;
}

struct PartRange {
  std::size_t first = 0, end = 0;
};

/// The parts of A and B that can be the first to touch.
std::pair<PartRange, PartRange> FirstToTouch(const Actor& a, const Actor& b) {
  constexpr double kShared_m = 0.01;  // of their heights
  const auto shell_a = ShellOf(a), shell_b = ShellOf(b);
  if (shell_a && shell_b &&
      std::abs(shell_a->z - shell_b->z) < shell_a->half_z + shell_b->half_z - kShared_m) {
    return {{shell_a->part, shell_a->part + 1}, {shell_b->part, shell_b->part + 1}};
  }
  return {{0, a.parts().size()}, {0, b.parts().size()}};
}

/// A mesh on the floor: up to four of its vertices at or below it, the deepest and those that span the most.
ContactList MeshOnFloor(const MeshData& mesh, const PlacedRotation& place) {
  std::vector<Vector3> low;
  for (const Vector3& v : mesh.vertices) {
    const Vector3 p = place.point(v);
    if (p.z() <= 0) low.push_back(p);
  }
  ContactList list;
  const auto take = [&](auto measure) {
    if (low.empty()) return;
    const auto best = std::ranges::max_element(low, {}, measure);
    if (list.count > 0 && !(measure(*best) > 0)) return;
    list.points[static_cast<std::size_t>(list.count++)] = {*best, Vector3::UnitZ(), -best->z()};
    low.erase(best);
  };
  const auto at = [&list](std::size_t i) -> const Vector3& { return list.points[i].p_W; };
  const auto side = [&](const Vector3& p) {
    const Vector3 along = at(1) - at(0);
    return along.x() * (p.y() - at(0).y()) - along.y() * (p.x() - at(0).x());
  };
  take([](const Vector3& p) { return -p.z(); });
  if (list.count == 1) take([&](const Vector3& p) { return (p - at(0)).head<2>().squaredNorm(); });
  if (list.count == 2) {
    take([&](const Vector3& p) { return side(p); });
    take([&](const Vector3& p) { return -side(p); });
  }
  return list;
}

}  // namespace

Collider::Collider() {
  EnsureOde();
  a_ = MakeGeoms();
  b_ = MakeGeoms();
  floor_.reset(dCreatePlane(nullptr, 0, 0, 1, 0));
}

OdeMesh::OdeMesh(const MeshData& mesh) : data_(dGeomTriMeshDataCreate()) {
  for (const Vector3& v : mesh.vertices) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
  for (const auto& triangle : mesh.triangles)
    indices_.insert(indices_.end(), triangle.begin(), triangle.end());
  dGeomTriMeshDataBuildDouble(data_.get(), vertices_.data(), 3 * sizeof(double),
                              static_cast<int>(mesh.vertices.size()), indices_.data(),
                              static_cast<int>(indices_.size()), 3 * sizeof(dTriIndex));
  geom_.reset(dCreateTriMesh(nullptr, data_.get(), nullptr, nullptr, nullptr));
}

Collider::Geoms Collider::MakeGeoms() {
  return {OdeGeomPtr(dCreateBox(nullptr, 1, 1, 1)),
          OdeGeomPtr(dCreateCylinder(nullptr, 1, 1)),
          OdeGeomPtr(dCreateSphere(nullptr, 1)),
          OdeGeomPtr(dCreateCapsule(nullptr, 1, 1)),
          {}};
}

dGeomID Collider::Geoms::Become(const PlacedPart& part) {
  dGeomID geom = nullptr;
  if (const Box* of_box = std::get_if<Box>(&part.part->shape)) {
    geom = box.get();
    dGeomBoxSetLengths(geom, of_box->size_m.x(), of_box->size_m.y(), of_box->size_m.z());
  } else if (const Cylinder* of_cylinder = std::get_if<Cylinder>(&part.part->shape)) {
    geom = cylinder.get();
    dGeomCylinderSetParams(geom, of_cylinder->radius_m, of_cylinder->length_m);
  } else if (const Sphere* of_sphere = std::get_if<Sphere>(&part.part->shape)) {
    geom = sphere.get();
    dGeomSphereSetRadius(geom, of_sphere->radius_m);
  } else if (const Capsule* of_capsule = std::get_if<Capsule>(&part.part->shape)) {
    geom = capsule.get();
    dGeomCapsuleSetParams(geom, of_capsule->radius_m, of_capsule->length_m);
  } else {
    const MeshData& data = *std::get<Mesh>(part.part->shape).data;
    geom = meshes.try_emplace(data.id, data).first->second.geom();
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

ContactList Collide(Collider& collider, const PlacedPart& a, const PlacedPart& b, double margin_m) {
  ContactList list;
  if (TryClosedForm(a, b, margin_m, list)) return list;
  if (TryClosedForm(b, a, margin_m, list)) return Reversed(list);
  // Four corners carry a box; the cylinder's colliders do not choose well among theirs, so they give all.
  const bool boxes = std::holds_alternative<Box>(a.part->shape) && std::holds_alternative<Box>(b.part->shape);
  list = collider.Collide(a, b, boxes ? 4 : ContactList::kMax);
  if (!boxes || list.count > 0 || !HasAlmostParallelEdges(a, b)) return list;
  // Boxes that only touch are left alone.
  constexpr double kOverlap_m = 1e-7;
  const ContactList turned = collider.Collide(a, Turned(b, a), 4);
  const bool overlap =
      std::ranges::any_of(turned.all(), [](const ContactPoint& one) { return one.depth_m > kOverlap_m; });
  return overlap ? turned : list;
}

ContactList CollideFloor(Collider& collider, const PlacedPart& a, double margin_m) {
  const PlacedRotation place = a.place();
  if (const Sphere* sphere = std::get_if<Sphere>(&a.part->shape)) {
    const double depth = sphere->radius_m - place.p[2];
    if (depth <= -margin_m) return {};
    return AsList({true, ContactPoint{{place.p[0], place.p[1], -depth}, Vector3::UnitZ(), depth}});
  }
  const Cylinder* cylinder = std::get_if<Cylinder>(&a.part->shape);
  if (cylinder != nullptr && a.part->wheel >= 0) {
    const ClosedForm form = WheelOnFloor(cylinder->radius_m, place, margin_m);
    if (form.applies) return WheelList(form, 0);
  }
  if (place.p[2] >= a.half_m.z()) return {};
  if (const Mesh* mesh = std::get_if<Mesh>(&a.part->shape)) return MeshOnFloor(*mesh->data, place);
  return collider.CollideFloor(a, 4);
}

void FindContacts(Collider& collider, const Actor& a, const Actor& b, double margin_m,
                  std::vector<FoundContact>& found) {
  const auto [range_a, range_b] = FirstToTouch(a, b);
  for (std::size_t i = range_a.first; i < range_a.end; ++i) {
    const PlacedPart part_a = a.Place(i);
    for (std::size_t j = range_b.first; j < range_b.end; ++j) {
      const PlacedPart part_b = b.Place(j);
      if (!Near(part_a, part_b, margin_m)) continue;
      const ContactList list = Collide(collider, part_a, part_b, margin_m);
      for (const ContactPoint& point : list.all()) {
        found.push_back({point, part_a.part, part_b.part, list.wheel});
      }
    }
  }
}

void FindFloorContacts(Collider& collider, const Actor& a, double margin_m,
                       std::vector<FoundContact>& found) {
  const Mechanism& mechanism = *a.thing.mechanism;
  for (std::size_t i = 0; i < mechanism.parts.size(); ++i) {
    if (mechanism.one_body() && mechanism.planar() && mechanism.parts[i].wheel < 0) continue;
    const PlacedPart part = a.Place(i);
    const ContactList list = CollideFloor(collider, part, margin_m);
    for (const ContactPoint& point : list.all()) found.push_back({point, part.part, nullptr, list.wheel});
  }
}

}  // namespace coopdyn
