// SPDX-License-Identifier: MIT
#include "server/physics/contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/base/portable_math.h"
#include "server/geometry/mesh.h"
#include "server/physics/box_contacts.h"
#include "server/physics/convex_contacts.h"

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

/// Whether a closed form applies. Stores its contact in `list`.
bool TryClosedForm(const PlacedPart& a, const PlacedPart& b, double margin_m, ContactList& list) {
  ClosedForm form;
  if (const Sphere* sphere = std::get_if<Sphere>(&a.part->shape)) {
    const Vector3 p_WA = a.place().position();
    if (const Box* box = std::get_if<Box>(&b.part->shape)) {
      form = SphereAndBox(*sphere, p_WA, *box, b.place(), kAhead_m);
    } else if (const Sphere* other = std::get_if<Sphere>(&b.part->shape)) {
      form = SphereAndSphere(*sphere, p_WA, *other, b.place().position(), kAhead_m);
    }
    list = AsList(form);
    return form.applies;
  }
  const Cylinder* cylinder = std::get_if<Cylinder>(&a.part->shape);
  if (cylinder == nullptr) return false;
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

/// The bounding box of several parts, along the axes of W.
class AroundParts {
 public:
  void Include(const PlacedPart& part) {
    for (int i = 0; i < 3; ++i) {
      low_[i] = std::min(low_[i], part.p[i] - part.half_m[i]);
      high_[i] = std::max(high_[i], part.p[i] + part.half_m[i]);
    }
  }
  bool IsNear(const PlacedPart& part, double margin_m) const {
    for (int i = 0; i < 3; ++i) {
      if (part.p[i] + part.half_m[i] + margin_m < low_[i] || part.p[i] - part.half_m[i] - margin_m > high_[i])
        return false;
    }
    return true;
  }

 private:
  Vector3 low_ = Vector3::Constant(kNoHit), high_ = -low_;
};

/// A robot's upright shell, or an upright box or cylinder. If the shells of two things overlap in height, no
/// other parts can touch first.
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

/// Indices of selected contacts across a plane: all, or, of more than kMost, the deepest and up to three that
/// span the most.
struct Few {
  static constexpr std::size_t kMost = 4;
  std::array<std::size_t, kMost> at{};
  std::size_t count = 0;
  std::span<const std::size_t> all() const& { return {at.data(), count}; }
  std::span<const std::size_t> all() && = delete;  // the span would outlive it
};
Few Spread(std::span<const ContactPoint> contacts) {
  Few few;
  if (contacts.size() <= Few::kMost) {
    for (std::size_t i = 0; i < contacts.size(); ++i) few.at[few.count++] = i;
    return few;
  }
  const Vector3 n = contacts.front().n_W;
  const auto take = [&](auto measure) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (std::ranges::find(few.all(), i) != few.all().end()) continue;
      if (!best || measure(contacts[i]) > measure(contacts[*best])) best = i;
    }
    if (few.count == 0 || measure(contacts[*best]) > 0) few.at[few.count++] = *best;
  };
  const auto from = [&](std::size_t i, const ContactPoint& to) {
    const Vector3 way = to.p_W - contacts[few.at[i]].p_W;
    return Vector3(way - n.dot(way) * n);
  };
  const auto side = [&](const ContactPoint& one) {
    return n.dot(from(0, contacts[few.at[1]]).cross(from(0, one)));
  };
  take([](const ContactPoint& one) { return one.depth_m; });
  take([&](const ContactPoint& one) { return from(0, one).squaredNorm(); });
  if (few.count == 2) {
    take([&](const ContactPoint& one) { return side(one); });
    take([&](const ContactPoint& one) { return -side(one); });
  }
  return few;
}

ContactList ListOf(std::span<const ContactPoint> contacts) {
  ContactList list;
  const Few few = Spread(contacts);
  for (const std::size_t i : few.all()) list.points[static_cast<std::size_t>(list.count++)] = contacts[i];
  return list;
}

/// Whether these are different convex pieces of one mesh.
bool ArePieces(const Part* p, const Part* q) {
  return p != q && p != nullptr && q != nullptr && p->link == q->link && p->collision == q->collision;
}

/// Whether both contacts belong to the same two solids (a mesh with all its pieces is one) and lie in one
/// plane.
bool AreAlike(const FoundContact& one, const FoundContact& other) {
  constexpr double kSameWay = 0.999, kSamePlane_m = 1e-3;
  if (std::abs(one.point.n_W.dot(other.point.p_W - one.point.p_W)) > kSamePlane_m) return false;
  const auto is_same = [](const Part* p, const Part* q) { return p == q || ArePieces(p, q); };
  return one.wheel < 0 && other.wheel < 0 && is_same(one.a, other.a) && is_same(one.b, other.b) &&
         one.point.n_W.dot(other.point.n_W) > kSameWay;
}

/// Reduces the contacts of a mesh's pieces, from `first` on, to as few as those of one solid: each contact
/// costs the solver as much as a joint.
void ThinOut(std::size_t first, std::vector<FoundContact>& found) {
  if (found.size() - first <= Few::kMost) return;
  std::vector<FoundContact> open(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
  const bool has_pieces = std::ranges::any_of(open, [&](const FoundContact& one) {
    return std::ranges::any_of(open, [&](const FoundContact& other) {
      return ArePieces(one.a, other.a) || ArePieces(one.b, other.b);
    });
  });
  if (!has_pieces) return;
  found.resize(first);
  std::vector<FoundContact> alike;
  std::vector<ContactPoint> points;
  while (!open.empty()) {
    const FoundContact one = open.front();
    alike.assign(1, one);
    points.assign(1, one.point);
    open.erase(open.begin());
    std::erase_if(open, [&](const FoundContact& other) {
      if (!AreAlike(one, other)) return false;
      alike.push_back(other);
      points.push_back(other.point);
      return true;
    });
    const Few few = Spread(points);
    for (const std::size_t i : few.all()) found.push_back(alike[i]);
  }
}

/// Contacts of a mesh with the floor: some of its lowest vertices.
ContactList MeshOnFloor(const MeshData& mesh, const PlacedRotation& place, double margin_m) {
  std::vector<ContactPoint> low;
  for (const Vector3& v : mesh.vertices) {
    const Vector3 p = place.point(v);
    if (p.z() <= margin_m) low.push_back({p, Vector3::UnitZ(), -p.z()});
  }
  return ListOf(low);
}

ContactList BoxOnFloor(const Box& box, const PlacedRotation& place, double margin_m) {
  std::vector<ContactPoint> low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 signs(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
    const Vector3 p = place.point(signs.cwiseProduct(box.size_m));
    if (p.z() < margin_m) low.push_back({p, Vector3::UnitZ(), -p.z()});
  }
  return ListOf(low);
}

/// Whether these triangles are the whole surface of a convex solid, and few enough to check one by one.
bool IsConvexSolid(const MeshData& mesh) {
  constexpr std::size_t kMostVertices = 1000;
  const std::size_t vertices = mesh.vertices.size();
  // A closed surface of triangles without holes has F = 2 V − 4 (Euler).
  if (vertices > kMostVertices || 2 * vertices != mesh.triangles.size() + 4) return false;
  const double rounding = 1e-6 * mesh.radius_m * mesh.radius_m * mesh.radius_m;
  return std::ranges::all_of(mesh.triangles, [&](const MeshData::Triangle& t) {
    const Vector3& p = mesh.vertices[t[0]];
    const Vector3 n = (mesh.vertices[t[1]] - p).cross(mesh.vertices[t[2]] - p);
    return std::ranges::all_of(mesh.vertices, [&](const Vector3& v) { return n.dot(v - p) <= rounding; });
  });
}

/// Whether ODE misses contacts of these two, places them beside the shapes, or finds depths that are far too
/// large.
bool OdeErrs(const Shape& a, const Shape& b) {
  const auto is_sphere = [](const Shape& one) { return std::holds_alternative<Sphere>(one); };
  const auto is_mesh = [](const Shape& one) { return std::holds_alternative<Mesh>(one); };
  const auto is_cylinder = [](const Shape& one) { return std::holds_alternative<Cylinder>(one); };
  return is_mesh(a) || is_mesh(b) || ((is_cylinder(a) || is_cylinder(b)) && !is_sphere(a) && !is_sphere(b));
}

/// Whether moving A out by the deepest contact separates it from B.
bool ArePartedBy(const ContactList& list, const PlacedPart& a, const PlacedPart& b) {
  if (list.count == 0) return false;
  constexpr double kLeft_m = 1e-4;
  const auto deepest = std::ranges::max_element(list.all(), {}, &ContactPoint::depth_m);
  return OverlapAlong(a, b, deepest->n_W) < deepest->depth_m + kLeft_m;
}

ContactList ConvexContacts(const PlacedPart& a, const PlacedPart& b) {
  constexpr double kOverlap_m = 1e-7;
  // A drive's wheel that is not about to roll here, as at an edge, must not cling to it.
  const double margin_m = a.part->wheel >= 0 || b.part->wheel >= 0 ? 0 : kAhead_m;
  const Separation least = FindSeparation(a, b, margin_m);
  if (least.depth_m <= kOverlap_m - margin_m) return {};
  return ListOf(ContactsAlong(a, b, least, margin_m));
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
  is_convex_ = IsConvexSolid(mesh);
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
    geom = MeshOf(data).geom();
  }
  dGeomSetPosition(geom, part.p[0], part.p[1], part.p[2]);
  dGeomSetRotation(geom, part.R);
  return geom;
}

const OdeMesh& Collider::Geoms::MeshOf(const MeshData& data) {
  return meshes.try_emplace(data.id, data).first->second;
}

bool Collider::Geoms::IsConvex(const PlacedPart& part) {
  const Mesh* mesh = std::get_if<Mesh>(&part.part->shape);
  return mesh == nullptr || MeshOf(*mesh->data).is_convex();
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

ContactList Collider::CollideFloor(const PlacedPart& a, int max_contacts, double margin_m) {
  // The floor rises by the margin.
  dGeomPlaneSetParams(floor_.get(), 0, 0, 1, margin_m);
  ContactList list = Ask(a_.Become(a), floor_.get(), max_contacts);
  for (int i = 0; i < list.count; ++i) list.points[static_cast<std::size_t>(i)].depth_m -= margin_m;
  return list;
}

ContactList Collide(Collider& collider, const PlacedPart& a, const PlacedPart& b, double margin_m) {
  ContactList list;
  if (TryClosedForm(a, b, margin_m, list)) return list;
  if (TryClosedForm(b, a, margin_m, list)) return Reversed(list);
  const Shape &of_a = a.part->shape, &of_b = b.part->shape;
  const Box *box_a = std::get_if<Box>(&of_a), *box_b = std::get_if<Box>(&of_b);
  if (box_a != nullptr && box_b != nullptr) {
    return ListOf(BoxContacts(*box_a, a.place(), *box_b, b.place(), kAhead_m));
  }
  const bool convex = collider.IsConvex(a) && collider.IsConvex(b);
  if (convex && OdeErrs(of_a, of_b)) return ConvexContacts(a, b);
  list = collider.Collide(a, b, ContactList::kMax);
  return !convex || ArePartedBy(list, a, b) ? list : ConvexContacts(a, b);
}

/// Points of both ends' rims: the lowest, and those at each quarter turn from it. So a disc that spins and
/// leans is held where it will touch next, too.
ContactList CylinderOnFloor(const Cylinder& cylinder, const PlacedRotation& place, double ahead_m) {
  constexpr double kUpright = 1e-3;  // below this lean the points stay where they are on the rim
  const Vector3 axis = place.axis(2);
  Vector3 down = axis.z() * axis - Vector3::UnitZ();
  const double lean = down.norm();
  down = lean > kUpright ? Vector3(down / lean) : place.axis(0);
  const Vector3 side = axis.cross(down);
  std::vector<ContactPoint> touching;
  for (const double end : {-0.5, 0.5}) {
    const Vector3 middle = place.position() + end * cylinder.length_m * axis;
    for (const Vector3& way : {down, side, Vector3(-down), Vector3(-side)}) {
      const Vector3 p = middle + cylinder.radius_m * way;
      if (p.z() < ahead_m) touching.push_back({p, Vector3::UnitZ(), -p.z()});
    }
  }
  return ListOf(touching);
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
  const double ahead_m = std::min(margin_m, kAhead_m);
  if (cylinder != nullptr) return CylinderOnFloor(*cylinder, place, ahead_m);
  if (const Box* box = std::get_if<Box>(&a.part->shape)) return BoxOnFloor(*box, place, ahead_m);
  if (place.p[2] >= a.half_m.z() + ahead_m) return {};
  if (const Mesh* mesh = std::get_if<Mesh>(&a.part->shape)) return MeshOnFloor(*mesh->data, place, ahead_m);
  return collider.CollideFloor(a, 4, ahead_m);
}

void FindContacts(Collider& collider, const Actor& a, const Actor& b, double margin_m,
                  std::vector<FoundContact>& found) {
  const std::size_t first = found.size();
  const auto [range_a, range_b] = FirstToTouch(a, b);
  const auto collide = [&](const PlacedPart& part_a, const PlacedPart& part_b) {
    if (!Near(part_a, part_b, margin_m + kAhead_m)) return;
    const ContactList list = Collide(collider, part_a, part_b, margin_m);
    for (const ContactPoint& point : list.all()) {
      found.push_back({point, part_a.part, part_b.part, list.wheel});
    }
  };
  if (range_b.end - range_b.first == 1) {
    const PlacedPart part_b = b.Place(range_b.first);
    for (std::size_t i = range_a.first; i < range_a.end; ++i) collide(a.Place(i), part_b);
  } else {
    std::vector<PlacedPart> parts_b;
    AroundParts around_b;
    for (std::size_t j = range_b.first; j < range_b.end; ++j) {
      parts_b.push_back(b.Place(j));
      around_b.Include(parts_b.back());
    }
    for (std::size_t i = range_a.first; i < range_a.end; ++i) {
      const PlacedPart part_a = a.Place(i);
      if (!around_b.IsNear(part_a, margin_m + 2 * kAhead_m)) continue;
      for (const PlacedPart& part_b : parts_b) collide(part_a, part_b);
    }
  }
  ThinOut(first, found);
}

void FindFloorContacts(Collider& collider, const Actor& a, double margin_m,
                       std::vector<FoundContact>& found) {
  const std::size_t first = found.size();
  const Mechanism& mechanism = *a.thing.mechanism;
  for (std::size_t i = 0; i < mechanism.parts.size(); ++i) {
    if (mechanism.one_body() && mechanism.planar() && mechanism.parts[i].wheel < 0) continue;
    if (mechanism.has_limbs()) {
      const auto body = static_cast<std::size_t>(mechanism.parts[i].body);
      if (a.bodies[body].p_WB.z() > mechanism.limb_radii_m[body] + margin_m + kAhead_m) continue;
    }
    const PlacedPart part = a.Place(i);
    const ContactList list = CollideFloor(collider, part, margin_m);
    for (const ContactPoint& point : list.all()) found.push_back({point, part.part, nullptr, list.wheel});
  }
  ThinOut(first, found);
}

}  // namespace coopdyn
